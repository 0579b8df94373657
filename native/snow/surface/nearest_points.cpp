#include "snow/surface/nearest_points.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace snowbough::snow {
namespace {

/// The first distance searched, and its growth, until there are enough points.
constexpr float kFirstReach = 0.15f;
constexpr float kNextReach = 1.7f;
/// Distance added to that of each point, so that no point counts alone.
constexpr float kLeastDistance = 0.025f;

std::vector<CellGrid::Box> boxes_of(const std::vector<glm::vec3>& position,
                                    const std::vector<int32_t>& chosen) {
  std::vector<CellGrid::Box> boxes;
  boxes.reserve(chosen.size());
  for (const int32_t p : chosen) boxes.push_back({position[p], position[p]});
  return boxes;
}

}  // namespace

NearestPoints::NearestPoints(const std::vector<glm::vec3>& position, std::vector<int32_t> chosen,
                             const std::vector<uint8_t>& sheltered, float depth)
    : position_(position),
      chosen_(std::move(chosen)),
      sheltered_(sheltered),
      depth_(depth),
      grid_(boxes_of(position_, chosen_), 0.25f * depth) {}

PointMean NearestPoints::at(const glm::vec3& place, int32_t own, float farthest,
                            bool shelter) const {
  struct Found {
    float distance;
    int32_t point;
  };
  thread_local std::vector<Found> found;
  found.clear();
  for (float reach = kFirstReach * depth_; reach < farthest && found.size() < 4;
       reach *= kNextReach) {
    found.clear();
    grid_.visit(place - reach, place + reach, [&](int32_t i) {
      const int32_t q = chosen_[i];
      if (sheltered_[q] != 0 && !shelter) return;
      const float distance = glm::distance(position_[q], place);
      if (distance < reach) found.push_back({distance, q});
    });
  }
  std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.point < b.point;
  });
  PointMean mean{glm::ivec4(own), glm::vec4(0.0f)};
  for (int k = 0; k < 4 && k < static_cast<int>(found.size()); ++k) {
    mean.point[k] = found[k].point;
    mean.weight[k] = 1.0f / (found[k].distance + kLeastDistance * depth_);
  }
  if (found.empty()) mean.weight[0] = 1.0f;
  mean.weight /= mean.weight.x + mean.weight.y + mean.weight.z + mean.weight.w;
  return mean;
}

}  // namespace snowbough::snow
