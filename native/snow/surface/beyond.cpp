#include "snow/surface/beyond.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "snow/surface/map_sampler.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

/// Least upward component of the normal of a face that gives the thickness of its snow.
constexpr float kCarriesSnow = 0.3f;
/// Metres within which the other side of a piece is looked for.
constexpr double kOtherFace = 1e3;

}  // namespace

base::TriangleTree::Hit ground_at(const base::TriangleTree& tree,
                                  const std::vector<glm::vec3>& position,
                                  const std::vector<std::array<int32_t, 3>>& triangle,
                                  const glm::dvec3& place, double most, double highest) {
  const auto faces_up = [&](int32_t t) {
    const auto& [a, b, c] = triangle[static_cast<size_t>(t)];
    return glm::cross(position[b] - position[a], position[c] - position[a]).z > 0.0f;
  };
  const auto below = tree.first_along(0, place, {0.0, 0.0, -1.0}, 1e-5, most);
  if (below.triangle < 0 || faces_up(below.triangle)) return below;
  const auto above = tree.first_along(0, place, {0.0, 0.0, 1.0}, 1e-5, most);
  if (above.triangle < 0 || !faces_up(above.triangle)) return below;
  if (above.distance > highest) return {};
  return {above.triangle, -above.distance};
}

bool is_within(const base::TriangleTree& tree, const std::vector<glm::vec3>& position,
               const std::vector<std::array<int32_t, 3>>& triangle, const glm::dvec3& place) {
  const auto leaves = [&](const glm::dvec3& way) {
    const auto hit = tree.first_along(0, place, way, 1e-5, kOtherFace);
    if (hit.triangle < 0) return false;
    const auto& [a, b, c] = triangle[static_cast<size_t>(hit.triangle)];
    const glm::vec3 cross = glm::cross(position[b] - position[a], position[c] - position[a]);
    return glm::dot(cross, glm::vec3(way)) > 0.0f;
  };
  return leaves({0.0, 0.0, 1.0}) && leaves({1.0, 0.0, 0.0}) && leaves({-1.0, 0.0, 0.0});
}

Beyond::Beyond(const std::vector<Neighbour>& neighbours) : neighbours_(neighbours) {
  for (const Neighbour& one : neighbours) {
    const MapTopology& topology = one.source.topology;
    const auto texels = static_cast<size_t>(topology.resolution) * topology.resolution;
    if (topology.resolution < 2 || one.height.size() != texels) {
      throw std::invalid_argument("a neighbour's map must be resolution x resolution");
    }
    const auto first = static_cast<int32_t>(position_.size());
    first_point_.push_back(first);
    first_triangle_.push_back(static_cast<int32_t>(triangle_.size()));
    position_.insert(position_.end(), one.source.positions.begin(), one.source.positions.end());
    const std::vector<int32_t>& corner = topology.triangles;
    for (size_t c = 0; c < corner.size(); c += 3) {
      triangle_.push_back({first + corner[c], first + corner[c + 1], first + corner[c + 2]});
    }
  }
  if (triangle_.empty()) return;
  tree_ = std::make_unique<base::TriangleTree>(
      position_, triangle_, std::vector<int32_t>{0, static_cast<int32_t>(triangle_.size())});
}

Beyond::Below Beyond::below(const glm::dvec3& place, double most, double highest) const {
  Below found;
  if (!tree_) return found;
  const auto hit = ground_at(*tree_, position_, triangle_, place, most, highest);
  if (hit.triangle < 0) return found;
  found.drop = hit.distance;
  const auto& corner = triangle_[hit.triangle];
  const glm::vec3 a = position_[corner[0]];
  const glm::vec3 ab = position_[corner[1]] - a, ac = position_[corner[2]] - a;
  const glm::vec3 cross = glm::cross(ab, ac);
  const float up = std::abs(unit(cross).z);
  if (up < kCarriesSnow) return found;
  // The level coordinates of the place give its position in the triangle.
  const glm::vec3 to = glm::vec3(place) - a;
  const float second = (to.x * ac.y - to.y * ac.x) / cross.z;
  const float third = (ab.x * to.y - ab.y * to.x) / cross.z;
  const auto last = std::upper_bound(first_triangle_.begin(), first_triangle_.end(), hit.triangle);
  const auto n = static_cast<size_t>(last - first_triangle_.begin()) - 1;
  const Neighbour& one = neighbours_[n];
  const size_t t = static_cast<size_t>(hit.triangle - first_triangle_[n]) * 3;
  const std::vector<glm::vec2>& uv = one.source.topology.corner_uv;
  const glm::vec2 at = uv[t] * (1.0f - second - third) + uv[t + 1] * second + uv[t + 2] * third;
  const int32_t resolution = one.source.topology.resolution;
  found.thickness =
      std::abs(map_value(one.height.data(), resolution, map_sample(at, resolution))) / up;
  return found;
}

bool Beyond::surround(const glm::dvec3& place) const {
  return tree_ != nullptr && is_within(*tree_, position_, triangle_, place);
}

}  // namespace snowbough::snow
