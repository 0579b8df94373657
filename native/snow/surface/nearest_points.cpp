#include "snow/surface/nearest_points.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace snowbough::snow {
namespace {

/// The distance searched: the first one times a power of the growth.
constexpr float kFirstReach = 0.15f;
constexpr float kNextReach = 1.7f;
/// Distance added to that of each point, so that no point counts alone.
constexpr float kMinDistance = 0.025f;

std::vector<glm::vec3> places_of(const std::vector<glm::vec3>& position,
                                 const std::vector<int32_t>& chosen) {
  std::vector<glm::vec3> places;
  places.reserve(chosen.size());
  for (const int32_t p : chosen) places.push_back(position[p]);
  return places;
}

std::vector<int32_t> open_of(std::vector<int32_t> chosen, const std::vector<uint8_t>& sheltered) {
  std::erase_if(chosen, [&](int32_t p) { return sheltered[p] != 0; });
  return chosen;
}

}  // namespace

NearestPoints::NearestPoints(const std::vector<glm::vec3>& position, std::vector<int32_t> chosen,
                             const std::vector<uint8_t>& sheltered, float depth)
    : chosen_(std::move(chosen)),
      depth_(depth),
      open_(open_of(chosen_, sheltered)),
      open_tree_(places_of(position, open_)),
      tree_(places_of(position, chosen_)) {}

PointMean NearestPoints::at(const glm::vec3& place, int32_t own, float farthest,
                            bool shelter) const {
  float reach = 0.0f;
  for (float next = kFirstReach * depth_; next < farthest; next *= kNextReach) reach = next;
  const auto found = (shelter ? tree_ : open_tree_).nearest(place, reach);
  const std::vector<int32_t>& points = shelter ? chosen_ : open_;
  PointMean mean{glm::ivec4(own), glm::vec4(0.0f)};
  for (int k = 0; k < 4 && found[k].point >= 0; ++k) {
    mean.point[k] = points[found[k].point];
    mean.weight[k] = 1.0f / (found[k].distance + kMinDistance * depth_);
  }
  if (found[0].point < 0) mean.weight[0] = 1.0f;
  mean.weight /= mean.weight.x + mean.weight.y + mean.weight.z + mean.weight.w;
  return mean;
}

}  // namespace snowbough::snow
