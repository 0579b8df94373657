#include "render/tree/drop_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "shaders/lib/thin_limbs.h"

namespace snowbough::render {
namespace {

/// Tolerance for rounding of the shader that decides.
constexpr float kSlack = 1.001f;
/// Depths of snow are rounded up to steps, of which this many double the depth.
constexpr float kStepsPerDouble = 2.0f;
constexpr int32_t kNoSnow = std::numeric_limits<int32_t>::min();

/// Share of the drawn ones below which a patch of this number is dropped.
float dropped_share(float number) {
  return (1.0f - shared::kFading) * number;
}

}  // namespace

float drop_point(const DropSize& of, float snow) {
  const float width = shared::kDrawnWidth * (of.reach + snow);
  const float narrow = 1.0f / std::max(width, 1e-30f);
  if (of.number >= 1.0f) return narrow;
  const float share = dropped_share(of.number);
  // The share is the product of two, of the width and of the length, each at most 1.
  const float both = std::sqrt(share * shared::kMinLength / std::max(width * of.length, 1e-30f));
  const float one = share * narrow;
  const bool is_short = both * of.length < shared::kMinLength;
  return std::min(is_short ? both : one, narrow);
}

float leaf_drop_point(float size, float number) {
  return shared::kMinLeaf * std::sqrt(dropped_share(number)) / std::max(2.0f * size, 1e-30f);
}

int32_t reached(const std::vector<float>& points, float scale) {
  return static_cast<int32_t>(std::upper_bound(points.begin(), points.end(), kSlack * scale) -
                              points.begin());
}

DropOrder::DropOrder(std::vector<DropSize> sizes)
    : sizes_(std::move(sizes)), widest_(sizes_.size()) {
  float widest = 0.0f;
  for (size_t i = sizes_.size(); i-- > 0;) {
    widest = std::max(widest, sizes_[i].reach);
    widest_[i] = widest;
  }
}

const std::vector<float>& DropOrder::drop_points(float snow) {
  const bool bare = snow <= 0.0f;
  const int32_t step =
      bare ? kNoSnow : static_cast<int32_t>(std::ceil(kStepsPerDouble * std::log2(snow)));
  std::vector<float>& points = drop_points_[step];
  if (points.empty()) {
    const float depth = bare ? 0.0f : std::exp2(static_cast<float>(step) / kStepsPerDouble);
    points.resize(sizes_.size());
    float least = std::numeric_limits<float>::max();
    for (size_t i = sizes_.size(); i-- > 0;) {
      least = std::min(least, drop_point(sizes_[i], depth));
      points[i] = least;
    }
  }
  return points;
}

int32_t DropOrder::needed(float scale, float snow, float round_from) {
  if (!std::isfinite(snow) || !std::isfinite(scale)) return count();
  const auto round = std::partition_point(widest_.begin(), widest_.end(), [&](float reach) {
    return kSlack * scale * (reach + std::max(snow, 0.0f)) > round_from;
  });
  return std::max(reached(drop_points(snow), scale), static_cast<int32_t>(round - widest_.begin()));
}

}  // namespace snowbough::render
