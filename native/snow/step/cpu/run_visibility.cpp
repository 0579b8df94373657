#include "snow/step/cpu/run_visibility.h"

#include <algorithm>
#include <cmath>

#include "snow/step/cpu/kernel.h"

namespace snowbough::snow::cpu {
namespace {

/// Half the distance between 1 and the next float.
constexpr double kRounding = 1.0 / 16777216.0;
/// Wider runs are evaluated per sample; within this size no float is off by more than a pixel.
constexpr double kWidest = 4096.0;
constexpr double kFarthest = 1e6;
constexpr int32_t kLanes = 8;

struct Range {
  double least = 1e300;
  double most = -1e300;

  void include(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
};

/// Bounds of the samples, and of their planes' depth at local pixel (0, 0).
struct Extent {
  Range x;
  Range y;
  Range depth;
  Range plane;
};

/// From the corners of the part of the triangle's plane within the weights' bounds.
Extent extent_of(const RunPlane& run) {
  Extent extent;
  const auto include = [&](double b, double c) {
    const double x = run.corner.x + b * run.edge_b.x + c * run.edge_c.x;
    const double y = run.corner.y + b * run.edge_b.y + c * run.edge_c.y;
    const double depth = run.corner.z + b * run.edge_b.z + c * run.edge_c.z;
    extent.x.include(x);
    extent.y.include(y);
    extent.depth.include(depth);
    extent.plane.include(depth - run.gradient.x * x - run.gradient.y * y);
  };
  for (const double b : {run.least_b, run.most_b}) {
    include(b, std::max<double>(run.least_c, run.least_sum - b));
    include(b, std::min<double>(run.most_c, run.most_sum - b));
  }
  for (const double c : {run.least_c, run.most_c}) {
    include(std::max<double>(run.least_b, run.least_sum - c), c);
    include(std::min<double>(run.most_b, run.most_sum - c), c);
  }
  return extent;
}

double length_of(float corner, float edge_b, float edge_c) {
  return std::abs(double{corner}) + std::abs(double{edge_b}) + std::abs(double{edge_c});
}

/// The largest of a run's coordinates, which determines rounding errors.
double farthest(const RunPlane& run) {
  return std::max(length_of(run.corner.x, run.edge_b.x, run.edge_c.x),
                  length_of(run.corner.y, run.edge_b.y, run.edge_c.y));
}

/// Bound of the rounding errors in metres of depth: of a sample's position (5 roundings) and depth
/// (4), of its comparison with the pixels (8), and of the loops below (8).
double rounding_of(const RunPlane& run, double pixels) {
  const double depth = length_of(run.corner.z, run.edge_b.z, run.edge_c.z);
  const double slope = std::abs(double{run.gradient.x}) + std::abs(double{run.gradient.y});
  return kRounding *
         (20.0 * (depth + double{run.reach}) + slope * (6.0 * farthest(run) + 8.0 * pixels + 16.0));
}

/// A plane above a rectangle of the tile's pixels.
struct Threshold {
  double at_zero;
  glm::vec2 gradient;
  /// Its largest depth.
  float most;

  /// Depth at the centre of a local pixel.
  float at(glm::ivec2 pixel) const {
    return static_cast<float>(at_zero + gradient.x * (pixel.x + 0.5) +
                              gradient.y * (pixel.y + 0.5));
  }
};

struct Pixels {
  PixelRect rect;
  const shared::SeenPixel* first;
  ptrdiff_t pitch;
};

/// Whether passes(depth, threshold's depth) holds for all pixels.
template <typename Passes>
inline bool all_pass(const Pixels& pixels, const Threshold& threshold, const Passes& passes) {
  const int32_t width = pixels.rect.size().x;
  const int32_t end = (width + kLanes - 1) / kLanes * kLanes;
  for (int32_t y = pixels.rect.low.y; y < pixels.rect.high.y; ++y) {
    const shared::SeenPixel* row = pixels.first + (y - pixels.rect.low.y) * pixels.pitch;
    const float first = threshold.at({pixels.rect.low.x, y});
    int32_t fails = 0;
    for (int32_t k = 0; k < end; ++k) {
      const float depth = first + static_cast<float>(k) * threshold.gradient.x;
      fails |= (k < width) & !passes(row[k].depth, depth);
    }
    if (fails != 0) return false;
  }
  return true;
}

/// Whether no pixel is in front of the threshold.
SNOWBOUGH_KERNEL bool all_behind(const Pixels& pixels, const Threshold& threshold) {
  return all_pass(pixels, threshold, [](float pixel, float depth) { return pixel >= depth; });
}

/// Whether all pixels are in front of the threshold.
SNOWBOUGH_KERNEL bool all_before(const Pixels& pixels, const Threshold& threshold) {
  return all_pass(pixels, threshold, [most = threshold.most](float pixel, float depth) {
    return pixel < (depth < most ? depth : most);
  });
}

int32_t floor_of(double value) {
  return static_cast<int32_t>(std::floor(value));
}

}  // namespace

RunVisibility visibility_of(const RunPlane& run, const Tile& tile, const shared::SeenPixel* seen) {
  const Extent extent = extent_of(run);
  const double wide = std::max(extent.x.most - extent.x.least, extent.y.most - extent.y.least);
  // Written so that NaN fails.
  if (!(wide <= kWidest && farthest(run) <= kFarthest)) return RunVisibility::kUnknown;
  const double off = 6.0 * kRounding * farthest(run);
  const PixelRect own{{floor_of(extent.x.least - off), floor_of(extent.y.least - off)},
                      {floor_of(extent.x.most + off) + 1, floor_of(extent.y.most + off) + 1}};
  const PixelRect& rect = tile.pixels;
  if (own.high.x <= rect.low.x || own.high.y <= rect.low.y || own.low.x >= rect.high.x ||
      own.low.y >= rect.high.y) {
    return RunVisibility::kElsewhere;
  }
  if (own.low.x < rect.low.x || own.low.y < rect.low.y || own.high.x > rect.high.x ||
      own.high.y > rect.high.y) {
    return RunVisibility::kUnknown;
  }
  // A sample reads the four pixels whose centres surround it.
  const PixelRect around{
      {floor_of(extent.x.least - 0.5 - off), floor_of(extent.y.least - 0.5 - off)},
      {floor_of(extent.x.most - 0.5 + off) + 2, floor_of(extent.y.most - 0.5 + off) + 2}};
  const PixelRect shown = tile.with_margin();
  const ptrdiff_t pitch = shown.size().x;
  const glm::ivec2 offset = around.low - shown.low;
  const Pixels pixels{around, seen + offset.y * pitch + offset.x, pitch};
  const double spare = rounding_of(run, wide + kLanes);
  const double open = extent.plane.most - run.depth_bias + spare;
  const Threshold behind{open, run.gradient, 0.0f};
  if (pixels.first->depth >= behind.at(around.low)) {
    return all_behind(pixels, behind) ? RunVisibility::kOpen : RunVisibility::kMixed;
  }
  const double hidden = double{run.reach} + spare;
  const Threshold before{extent.plane.least - hidden, run.gradient,
                         static_cast<float>(extent.depth.least - hidden)};
  return all_before(pixels, before) ? RunVisibility::kHidden : RunVisibility::kMixed;
}

}  // namespace snowbough::snow::cpu
