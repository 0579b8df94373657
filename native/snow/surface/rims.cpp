#include "snow/surface/rims.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/group_by_key.h"
#include "base/union_find.h"
#include "snow/surface/flip_edges.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

/// Upward component of normals: least value of a supporting face, greatest value of a far face.
constexpr float kCarries = 0.3f;
constexpr float kGoesDown = 0.35f;
/// Least difference of the upward components of the supporting and the far face.
constexpr float kTurnsDown = 0.45f;
/// Cosine of the least angle between the faces at a rim: 50 degrees, or 75 if they are smooth
/// shaded.
constexpr float kSharp = 0.643f;
constexpr float kSharpSmooth = 0.259f;
/// A point belongs to a rim's supporting or far face if the cosine between the normals of that face
/// and of the point's own face is at least this.
constexpr float kSameFace = 0.5f;
/// Greatest distance of a point from the plane of the rim's face, as a fraction of its distance to
/// the rim.
constexpr float kOffPlane = 0.55f;
/// Rims that are more than this many softnesses farther away than the nearest rim are ignored.
constexpr float kBlendRange = 4.0f;

float eased(float x, float from, float to) {
  const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

glm::vec3 nearest_on(const Rim& rim, const glm::vec3& point) {
  const glm::vec3 along = rim.to - rim.from;
  const float share = glm::dot(point - rim.from, along) / glm::dot(along, along);
  return rim.from + std::clamp(share, 0.0f, 1.0f) * along;
}

/// Length of the surface below the middle of the rim, in metres, measured in steps.
float far_extent(const Rim& rim, const base::TriangleTree& tree, float most) {
  if (rim.down == glm::vec3(0.0f)) return most;
  constexpr int kSteps = 6;
  const glm::vec3 middle = (rim.from + rim.to) * 0.5f;
  for (int k = 1; k <= kSteps; ++k) {
    const float along = most * static_cast<float>(k) / kSteps;
    const double off = 0.04 * most + 0.15 * along;
    if (tree.nearest(0, middle + rim.down * along).squared_distance > off * off) {
      return std::max(most * static_cast<float>(k - 1) / kSteps, 0.05f * most);
    }
  }
  return most;
}

/// Decides for each edge whether it is a rim.
class RimFinder {
 public:
  RimFinder(const SurfaceMesh& mesh, const std::vector<int32_t>& shading)
      : mesh_(mesh), shading_(shading), normals_(triangle_normals(mesh)) {}

  /// Returns true if the edge is a rim, and fills in `rim`.
  bool find(const std::array<int32_t, 2>& ends, const EdgeCorners& faces, Rim& rim) const {
    rim.from = mesh_.position[ends[0]];
    rim.to = mesh_.position[ends[1]];
    if (faces.count == 1) {
      const int32_t face = faces.corner[0].triangle;
      // The open edge of a smooth shell, such as an eye in its socket, is not a rim.
      if (normals_[face].z < kCarries || shading_number(face, ends[0]) >= 0) return false;
      rim.support = normals_[face];
      rim.far_normal = rim.down = glm::vec3(0.0f);
      rim.out = away(rim, face);
      return true;
    }
    if (faces.count != 2) return false;
    int32_t carrier = faces.corner[0].triangle;
    int32_t far = faces.corner[1].triangle;
    if (normals_[far].z > normals_[carrier].z) std::swap(carrier, far);
    const glm::vec3& a = normals_[carrier];
    const glm::vec3& b = normals_[far];
    const float sharp = is_smooth(ends, carrier, far) ? kSharpSmooth : kSharp;
    if (a.z < kCarries || glm::dot(a, b) > sharp || b.z > kGoesDown || b.z > a.z - kTurnsDown) {
      return false;
    }
    rim.support = a;
    rim.far_normal = b;
    rim.out = away(rim, carrier);
    rim.down = -away(rim, far);
    return glm::dot(rim.out, b) > 0.0f;
  }

 private:
  int32_t shading_number(int32_t face, int32_t point) const {
    if (shading_.empty()) return -1;
    for (int32_t k = 0; k < 3; ++k) {
      if (mesh_.triangle[face][k] == point) return shading_[mesh_.base[face] * 3 + k];
    }
    return -1;
  }
  /// True if both faces share their normals along the edge.
  bool is_smooth(const std::array<int32_t, 2>& ends, int32_t face, int32_t other) const {
    for (const int32_t point : ends) {
      const int32_t number = shading_number(face, point);
      if (number < 0 || number != shading_number(other, point)) return false;
    }
    return true;
  }
  /// Unit vector in the plane of the face, across the rim and away from the face.
  glm::vec3 away(const Rim& rim, int32_t face) const {
    const auto& [a, b, c] = mesh_.triangle[face];
    const glm::vec3 middle = (mesh_.position[a] + mesh_.position[b] + mesh_.position[c]) / 3.0f;
    const glm::vec3 across = glm::cross(unit(rim.to - rim.from), normals_[face]);
    return glm::dot(across, (rim.from + rim.to) * 0.5f - middle) > 0.0f ? across : -across;
  }

  const SurfaceMesh& mesh_;
  const std::vector<int32_t>& shading_;
  std::vector<glm::vec3> normals_;
};

}  // namespace

Rims::Rims(const SurfaceMesh& mesh, const base::TriangleTree& tree,
           const std::vector<int32_t>& shading, float reach, float far_reach)
    : reach_(reach) {
  const SurfaceEdges edges = surface_edges(mesh.triangle);
  const std::vector<EdgeCorners> faces = edge_corners(edges);
  base::UnionFind joined(mesh.position.size());
  for (const auto& [a, b, c] : mesh.triangle) joined.join(joined.join(a, b), c);
  const std::vector<int32_t> part = std::move(joined).all();
  for (const auto& triangle : mesh.triangle) part_of_triangle_.push_back(part[triangle[0]]);

  const RimFinder finder(mesh, shading);
  std::vector<Rim> found;
  for (size_t e = 0; e < edges.ends.size(); ++e) {
    Rim rim;
    if (!finder.find(edges.ends[e], faces[e], rim)) continue;
    rim.part = part[edges.ends[e][0]];
    rim.far_extent = far_extent(rim, tree, far_reach);
    found.push_back(rim);
  }
  const auto for_rims = [&](const auto& visit) {
    for (const Rim& rim : found) visit(rim.part, rim);
  };
  base::group_by_key(mesh.position.size(), for_rims, part_begin_, rims_);
  std::vector<CellGrid::Box> boxes;
  for (const Rim& rim : rims_) {
    boxes.push_back({glm::min(rim.from, rim.to), glm::max(rim.from, rim.to)});
  }
  grid_ = CellGrid(boxes, reach);
}

template <typename Visit>
void Rims::visit_near(const glm::vec3& point, int32_t part, const Visit& visit) const {
  // A part with few rims, such as a needle or a leaf, is searched in full: the cells around it hold
  // the rims of thousands of other parts.
  constexpr int32_t kFew = 48;
  const int32_t begin = part_begin_[static_cast<size_t>(part)];
  const int32_t end = part_begin_[static_cast<size_t>(part) + 1];
  if (end - begin <= kFew) {
    for (int32_t number = begin; number < end; ++number) visit(number);
    return;
  }
  const glm::vec3 around(reach_);
  grid_.visit(point - around, point + around, [&](int32_t number) {
    if (rims_[static_cast<size_t>(number)].part == part) visit(number);
  });
}

RimPlace Rims::place(const glm::vec3& point, const glm::vec3& normal, int32_t part,
                     float softness) const {
  struct Seen {
    int32_t rim;
    float distance;
    glm::vec3 foot;
    bool on_support;
  };
  thread_local std::vector<Seen> seen;
  seen.clear();
  float nearest = reach_;
  visit_near(point, part, [&](int32_t number) {
    const Rim& rim = rims_[number];
    const float to_support = glm::dot(normal, rim.support);
    const float to_far = glm::dot(normal, rim.far_normal);
    const bool on_support = to_support >= to_far - 0.02f;
    if ((on_support ? to_support : to_far) < kSameFace) return;
    const glm::vec3 foot = nearest_on(rim, point);
    const float distance = glm::distance(point, foot);
    if (distance >= reach_) return;
    const glm::vec3& plane = on_support ? rim.support : rim.far_normal;
    if (std::abs(glm::dot(point - foot, plane)) > kOffPlane * distance + 1e-6f) return;
    nearest = std::min(nearest, distance);
    seen.push_back({number, distance, foot, on_support});
  });
  RimPlace place;
  if (seen.empty()) return place;
  // A rim that overlaps several cells was visited once per cell. The result must not depend on the
  // order of the visits.
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.rim < b.rim;
  });
  seen.erase(std::unique(seen.begin(), seen.end(),
                         [](const Seen& a, const Seen& b) { return a.rim == b.rim; }),
             seen.end());
  const Rim& first = rims_[seen.front().rim];
  const bool on_support = seen.front().on_support;
  float sum = 0.0f;
  for (const Seen& one : seen) {
    if (one.distance > nearest + kBlendRange * softness) break;
    const Rim& rim = rims_[one.rim];
    if (one.on_support != on_support) continue;
    const float weight = std::exp((nearest - one.distance) / std::max(softness, 1e-6f)) *
                         eased(glm::dot(rim.out, first.out), -0.7f, -0.1f);
    place.out += weight * rim.out;
    place.level_out += weight * glm::vec3(rim.out.x, rim.out.y, 0.0f);
    place.down += weight * rim.down;
    place.foot += weight * one.foot;
    place.support += weight * rim.support;
    place.far_extent += weight * rim.far_extent;
    sum += weight;
  }
  place.is_far_off = false;
  place.distance = on_support ? nearest : -nearest;
  place.out = unit(place.out);
  place.level_out = unit(place.level_out);
  const float down = glm::length(place.down / sum);
  place.down /= sum * std::max(down, 0.3f);
  place.foot /= sum;
  place.far_extent /= sum;
  place.support = unit(place.support);
  place.has_far = first.far_normal != glm::vec3(0.0f);
  return place;
}

float Rims::distance(const glm::vec3& point, const glm::vec3& normal, int32_t part,
                     bool far_too) const {
  float nearest = reach_;
  visit_near(point, part, [&](int32_t number) {
    const Rim& rim = rims_[number];
    const bool may_carry = glm::dot(rim.support, normal) >= kSameFace;
    if (!may_carry && !(far_too && glm::dot(rim.far_normal, normal) >= kSameFace)) return;
    nearest = std::min(nearest, glm::distance(point, nearest_on(rim, point)));
  });
  return nearest;
}

float Rims::room(const RimPlace& place, int32_t part, float most) const {
  constexpr int kSteps = 8;
  float room = 0.0f;
  float before = 0.0f;
  for (int k = 1; k <= kSteps; ++k) {
    const glm::vec3 at = place.foot - place.out * (most * static_cast<float>(k) / kSteps);
    const float here = distance(at, place.support, part, false);
    if (here < before - 1e-6f) break;
    room = std::max(room, here);
    before = here;
  }
  return room;
}

Rims::Opposite Rims::opposite(const RimPlace& place, float most) const {
  Opposite found;
  float best = 0.0f;
  const glm::vec3 around(most);
  grid_.visit(place.foot - around, place.foot + around, [&](int32_t number) {
    const Rim& rim = rims_[number];
    const float against = -glm::dot(rim.out, place.out);
    if (against < 0.5f) return;
    const glm::vec3 across = nearest_on(rim, place.foot) - place.foot;
    const float gap = glm::dot(across, place.level_out);
    if (gap < 0.0f || gap >= most) return;
    const float aside = glm::length(glm::vec3(across.x, across.y, 0.0f) - gap * place.level_out);
    // Each factor falls off gradually, so that bridges do not end abruptly.
    const float nearness = eased(aside, 0.5f * most, 0.1f * most) *
                           eased(std::abs(across.z), most, 0.4f * most) *
                           eased(against, 0.5f, 0.85f);
    const float worth = nearness * (1.0f - gap / most);
    if (worth > best) {
      best = worth;
      found = {nearness, gap, across.z};
    }
  });
  return found;
}

}  // namespace snowbough::snow
