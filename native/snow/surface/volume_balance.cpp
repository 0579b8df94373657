#include "snow/surface/volume_balance.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "base/parallel_for.h"

namespace snowbough::snow {
namespace {

/// Bounds of a factor.
constexpr float kMinFactor = 0.75f;
constexpr float kMaxFactor = 1.25f;

}  // namespace

VolumeBalance::VolumeBalance(const std::vector<glm::vec3>& position, float size)
    : near_(position.size()) {
  struct Placed {
    std::array<float, 3> corner;  // whole numbers, however far from the origin
    int32_t point, place;
  };
  std::vector<Placed> placed;
  placed.reserve(8 * position.size());
  for (size_t p = 0; p < position.size(); ++p) {
    const glm::vec3 at = position[p] / size;
    const glm::vec3 cell = glm::floor(at);
    const glm::vec3 part = at - cell;
    for (int k = 0; k < 8; ++k) {
      const glm::vec3 side(k & 1, k >> 1 & 1, k >> 2);
      const glm::vec3 share = glm::mix(1.0f - part, part, side);
      near_[p].share[k] = share.x * share.y * share.z;
      const glm::vec3 corner = cell + side;
      placed.push_back({{corner.x, corner.y, corner.z}, static_cast<int32_t>(p), k});
    }
  }
  std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
    return a.corner != b.corner ? a.corner < b.corner : a.point < b.point;
  });
  for (size_t i = 0; i < placed.size(); ++i) {
    if (i > 0 && placed[i].corner != placed[i - 1].corner) ++corners_;
    near_[placed[i].point].corner[placed[i].place] = static_cast<int32_t>(corners_);
  }
  if (!placed.empty()) ++corners_;
}

std::vector<float> VolumeBalance::factors(const std::vector<glm::vec2>& volumes) const {
  // Each corner spreads what is too little around it in proportion to what is drawn there, so that
  // the sum over all points is right.
  std::vector<glm::dvec2> sum(corners_, glm::dvec2(0.0));
  for (size_t p = 0; p < near_.size(); ++p) {
    for (int k = 0; k < 8; ++k) {
      sum[near_[p].corner[k]] += glm::dvec2(volumes[p] * near_[p].share[k]);
    }
  }
  std::vector<float> of_corner(corners_, 1.0f);
  for (size_t c = 0; c < corners_; ++c) {
    if (sum[c].y <= 0.0) continue;
    of_corner[c] = std::clamp(static_cast<float>(sum[c].x / sum[c].y), kMinFactor, kMaxFactor);
  }
  std::vector<float> factors(near_.size(), 0.0f);
  base::for_each_item(factors.size(), 2048, [&](size_t p) {
    for (int k = 0; k < 8; ++k) factors[p] += near_[p].share[k] * of_corner[near_[p].corner[k]];
  });
  return factors;
}

}  // namespace snowbough::snow
