#include "snow/surface/point_looks.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"
#include "base/union_find.h"
#include "shaders/lib/snow_point.h"

namespace snowbough::snow {
namespace {

/// Assumed thickness of a sheet, which has no back side, as a fraction of the square root of its
/// area.
constexpr float kSheetThickness = 0.012f;
/// A top with more room than the first fraction of the depth is wide; one with less than the second
/// is narrow.
constexpr float kWideRoom = 0.8f;
constexpr float kNarrowRoom = 0.35f;
/// Triangles between points whose normals' upward components differ by more are folds.
constexpr float kFoldsUp = 0.45f;

void find_thickness(PointLooks& looks, const SurfacePoints& points, const HeightSamples& samples,
                    const base::TriangleTree& tree, float depth) {
  base::UnionFind joined(points.count());
  for (const auto& [a, b, c] : points.mesh.triangle) joined.join(joined.join(a, b), c);
  const std::vector<int32_t> part = std::move(joined).all();
  std::vector<float> part_area(points.count(), 0.0f);
  for (size_t p = 0; p < points.count(); ++p) part_area[part[p]] += samples.area[p];
  looks.is_sheet.assign(points.count(), 0);
  base::for_each_item(points.count(), 256, [&](size_t p) {
    const glm::dvec3 inwards(-points.normal[p]);
    const double below =
        tree.first_along(0, glm::dvec3(points.mesh.position[p]), inwards, 1e-5).distance;
    const float sheet = kSheetThickness * std::sqrt(part_area[part[p]]);
    looks.is_sheet[p] = std::isfinite(below) ? 0 : 1;
    const float thickness = std::isfinite(below) ? static_cast<float>(below) : sheet;
    looks.point[p] = shared::on_carrier(looks.point[p], thickness, depth);
  });
}

void find_convexity(PointLooks& looks, const SurfacePoints& points, const HeightSamples& samples,
                    float depth) {
  // Compute the area of a surface offset by this height.
  const float height = 0.1f * depth;
  std::vector<float> outer(points.count(), 0.0f);
  std::vector<float> inner(points.count(), 0.0f);
  for (size_t t = 0; t < points.mesh.triangle.size(); ++t) {
    const auto& [a, b, c] = points.mesh.triangle[t];
    // Snow does not bend around the foot of a wall.
    const auto [least, most] = std::minmax({samples.up[a], samples.up[b], samples.up[c]});
    if (most - least > kFoldsUp) continue;
    const float own = 0.5f * glm::length(triangle_cross(points.mesh, t));
    const glm::vec3 raised = points.mesh.position[a] + height * points.normal[a];
    const float area = 0.5f * glm::length(glm::cross(
                                  points.mesh.position[b] + height * points.normal[b] - raised,
                                  points.mesh.position[c] + height * points.normal[c] - raised));
    for (const int32_t p : points.mesh.triangle[t]) {
      outer[p] += area / 3.0f;
      inner[p] += own / 3.0f;
    }
  }
  std::vector<float> convexity(points.count(), 0.0f);
  for (size_t p = 0; p < convexity.size(); ++p) {
    if (inner[p] > 0.0f) convexity[p] = std::max((outer[p] / inner[p] - 1.0f) / height, 0.0f);
  }
  constexpr int kRounds = 4;
  smooth(samples, convexity, kRounds);
  for (size_t p = 0; p < convexity.size(); ++p) looks.point[p].convexity = convexity[p];
}

}  // namespace

PointLooks point_looks(const SurfacePoints& points, const HeightSamples& samples,
                       const std::vector<RimZones::Zone>& zone, const base::TriangleTree& tree,
                       const glm::vec3& noise_shift, float depth) {
  PointLooks looks;
  looks.point.resize(points.count());
  base::for_each_item(points.count(), 1024, [&](size_t p) {
    looks.point[p] = shared::point_noise(points.mesh.position[p] / depth + noise_shift);
  });
  find_thickness(looks, points, samples, tree, depth);
  for (size_t p = 0; p < points.count(); ++p) {
    if (zone[p].place.is_far_off || zone[p].share < 0.0f) continue;
    looks.point[p].narrow = std::max(
        looks.point[p].narrow, shared::eased(zone[p].room, kWideRoom * depth, kNarrowRoom * depth));
  }
  find_convexity(looks, points, samples, depth);
  return looks;
}

void set_relief(PointLooks& looks, const std::vector<glm::vec3>& shown,
                const glm::vec3& noise_shift, float depth) {
  base::for_each_item(looks.point.size(), 1024, [&](size_t p) {
    const glm::vec3 place = shown[p] / depth + noise_shift;
    looks.point[p].relief = shared::relief_noise(place);
    looks.point[p].bumps = shared::bump_noise(place);
  });
}

}  // namespace snowbough::snow
