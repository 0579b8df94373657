#include "snow/surface/rim_zones.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"

namespace snowbough::snow {
namespace {

// As fractions of the snow depth on open ground.
constexpr float kRimZone = 1.25f;
constexpr float kFarZone = 0.34f;
constexpr float kRimStrip = 0.34f;
/// Least upward component of the normal of a face at the foot of a far face.
constexpr float kLies = 0.4f;

}  // namespace

float rim_zone(float depth) {
  return kRimZone * depth;
}

float far_zone(float depth) {
  return kFarZone * depth;
}

float rim_strip(float depth) {
  return kRimStrip * depth;
}

RimZones::RimZones(const SurfaceMesh& receiver, const Rims& rims, float depth, bool needles)
    : rims_(rims), depth_(depth), needles_(needles) {
  const std::vector<glm::vec3> normals = triangle_normals(receiver);
  for (size_t t = 0; t < receiver.base.size(); ++t) {
    const auto base = static_cast<size_t>(receiver.base[t]);
    if (part_of_base_.size() <= base) {
      part_of_base_.resize(base + 1, -1);
      normal_of_base_.resize(base + 1, glm::vec3(0.0f));
    }
    part_of_base_[base] = rims.parts()[t];
    normal_of_base_[base] = normals[t];
  }
}

void RimZones::find(const SurfaceMesh& mesh, std::vector<Zone>& zones) const {
  const size_t known = zones.size();
  zones.resize(mesh.position.size());
  // For each new point: one face in each plane that contains the point.
  constexpr size_t kPlanes = 4;
  struct Planes {
    std::array<int32_t, kPlanes> face;
    size_t count = 0;
  };
  // Use the receiver's normals: triangles of the refined mesh may be too narrow to have one.
  const auto normal = [&](int32_t t) {
    return normal_of_base_[static_cast<size_t>(mesh.base[static_cast<size_t>(t)])];
  };
  std::vector<Planes> planes(zones.size() - known);
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    for (const int32_t p : mesh.triangle[t]) {
      if (static_cast<size_t>(p) < known) continue;
      Planes& own = planes[static_cast<size_t>(p) - known];
      bool is_new = own.count < kPlanes;
      for (size_t i = 0; i < own.count; ++i) {
        is_new =
            is_new && glm::distance(normal(static_cast<int32_t>(t)), normal(own.face[i])) > 0.05f;
      }
      if (is_new) own.face[own.count++] = static_cast<int32_t>(t);
    }
  }
  base::for_each_item(planes.size(), 256, [&](size_t i) {
    constexpr float kOnRim = 1e-4f;
    Zone& best = zones[known + i];
    Zone lying;
    bool is_foot = false;
    for (size_t k = 0; k < planes[i].count; ++k) {
      const int32_t t = planes[i].face[k];
      const Zone zone = at(mesh.position[known + i], normal(t), part(mesh.base[t]));
      if (normal(t).z > kLies && (zone.place.is_far_off || zone.share >= 0.0f)) {
        is_foot = true;
        const bool is_nearer = lying.place.is_far_off || zone.share < lying.share;
        if (!zone.place.is_far_off && is_nearer) lying = zone;
      }
      if (zone.place.is_far_off) continue;
      const float nearer = std::abs(best.share) - std::abs(zone.share);
      if (best.place.is_far_off || nearer > kOnRim ||
          (nearer > -kOnRim && zone.share >= 0.0f && best.share < 0.0f)) {
        best = zone;
      }
    }
    // Snow also lies on the face at the foot of a far face: it has the shape that it has there.
    if (is_foot && best.share < 0.0f) best = lying;
  });
}

RimZones::Zone RimZones::at(const glm::vec3& point, const glm::vec3& normal, int32_t part) const {
  Zone zone;
  zone.place = rims_.place(point, normal, part, 0.25f * depth_);
  if (zone.place.is_far_off) return zone;
  const float most = rim_zone(depth_);
  zone.room = rims_.room(zone.place, part, most, !needles_);
  zone.support = std::clamp(0.95f * zone.room, 0.1f * depth_, most);
  zone.far = std::max(std::min(far_zone(depth_), zone.place.far_extent), 0.02f * depth_);
  zone.share = zone.place.distance / (zone.place.distance < 0.0f ? zone.far : zone.support);
  return zone;
}

}  // namespace snowbough::snow
