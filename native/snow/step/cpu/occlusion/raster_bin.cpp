#include "snow/step/cpu/occlusion/raster_bin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "shaders/lib/occlusion_pixel.h"
#include "snow/step/cpu/kernel.h"
#include "snow/step/cpu/occlusion/grid_triangle.h"
#include "snow/step/cpu/occlusion/triangle_bins.h"

namespace snowbough::snow::cpu {
namespace {

constexpr int32_t kLanes = 8;
/// Triangles up to this many pixels per side are tested pixel by pixel in 32 bits, larger ones row
/// by row.
constexpr int32_t kSmallPixels = 64;
constexpr float kSmall = static_cast<float>(kSmallPixels);
/// Corners up to this many pixels from the grid's origin use exact integer steps: products of two
/// distances in steps fit 62 bits. Beyond, floats are coarser than a step.
constexpr float kExactPixel = 1 << 20;

/// The bin's pixels. Vectors may end behind the last one.
struct BinPixels {
  alignas(32) float depth[kBinSize * kBinSize + kLanes];
  alignas(32) uint32_t seen[kBinSize * kBinSize + kLanes];
};

void clear(BinPixels& bin) {
  std::fill(std::begin(bin.depth), std::end(bin.depth), std::numeric_limits<float>::infinity());
  std::fill(std::begin(bin.seen), std::end(bin.seen), 0u);
}

void load(const SeenPixels& pixels, BinPixels& bin) {
  const glm::ivec2 size = pixels.rect.size();
  for (int32_t y = 0; y < size.y; ++y) {
    const shared::SeenPixel* row = pixels.first + y * pixels.pitch;
    for (int32_t x = 0; x < size.x; ++x) {
      bin.seen[y * kBinSize + x] = row[x].triangle;
      bin.depth[y * kBinSize + x] =
          row[x].triangle != 0 ? row[x].depth : std::numeric_limits<float>::infinity();
    }
  }
}

void store(const BinPixels& bin, const SeenPixels& pixels) {
  const glm::ivec2 size = pixels.rect.size();
  for (int32_t y = 0; y < size.y; ++y) {
    shared::SeenPixel* row = pixels.first + y * pixels.pitch;
    const uint32_t* seen = bin.seen + y * kBinSize;
    const float* depth = bin.depth + y * kBinSize;
    for (int32_t x = 0; x < size.x; ++x) {
      row[x] = {seen[x], seen[x] != 0 ? depth[x] : shared::kOpenSky};
    }
  }
}

void store_nothing(const SeenPixels& pixels) {
  const glm::ivec2 size = pixels.rect.size();
  for (int32_t y = 0; y < size.y; ++y) {
    std::fill_n(pixels.first + y * pixels.pitch, size.x, shared::SeenPixel{0, shared::kOpenSky});
  }
}

/// The triangle being drawn: corners snapped to the grid's steps, in pixels.
struct GridTriangle {
  glm::vec3 a;
  glm::vec3 b;
  glm::vec3 c;
  shared::DepthPlane plane;

  GridTriangle(const glm::vec4* corners, uint32_t index)
      : a(shared::snapped(corners[0])),
        b(shared::snapped(corners[1])),
        c(shared::snapped(corners[2])),
        plane(shared::depth_plane(a, b, c, index)) {}
};

/// Draws into a row's pixels from x on where `beyond(k)` is not negative, in whole vectors: `count`
/// rounded up to kLanes. `offset_y`: of their centres from the plane's corner; `depth` and `seen`:
/// of the first.
template <typename Beyond>
inline void draw_lanes(const shared::DepthPlane& plane, int32_t x, int32_t count, float offset_y,
                       const Beyond& beyond, float* __restrict depth, uint32_t* __restrict seen) {
  const glm::vec4 corner_gradient = plane.corner_gradient;
  const glm::vec3 range = plane.range;
  const uint32_t own_seen = plane.seen;
  const int32_t end = (count + kLanes - 1) / kLanes * kLanes;
  for (int32_t k = 0; k < end; ++k) {
    const float offset_x = static_cast<float>(x + k) + 0.5f - corner_gradient.x;
    const float own = shared::depth_at(offset_x, offset_y, corner_gradient, range);
    const bool shows = (beyond(k) >= 0) & (own < depth[k]);
    depth[k] = shows ? own : depth[k];
    seen[k] = shows ? own_seen : seen[k];
  }
}

/// One side of a small triangle: negative outside, at the centre of a row's first pixel.
struct Side {
  int32_t value;
  int32_t right;
  int32_t up;

  /// Corners in steps from the first pixel's centre, anticlockwise.
  Side(glm::ivec2 from, glm::ivec2 to) {
    const glm::ivec2 way = to - from;
    // A centre on the line belongs to the triangle at its right or, if the line is level, above it.
    const bool holds_line = way.y < 0 || (way.y == 0 && way.x > 0);
    value = way.y * from.x - way.x * from.y - (holds_line ? 0 : 1);
    right = -way.y * kSteps;
    up = way.x * kSteps;
  }

  /// At the centre of the k-th pixel of the row.
  int32_t at(int32_t k) const { return value + k * right; }
};

/// Draws a triangle of at most kSmallPixels width and height into the pixels `covered` by its
/// bounds.
inline void draw_small(const GridTriangle& triangle, const PixelRect& covered,
                       const PixelRect& rect, BinPixels& bin) {
  // No vector crosses the end of the bin's row: a single one is shifted, several start at its
  // beginning.
  const int32_t column = covered.low.x - rect.low.x;
  const int32_t first_x =
      rect.low.x + (covered.high.x - covered.low.x <= kLanes ? std::min(column, kBinSize - kLanes)
                                                             : column / kLanes * kLanes);
  const auto steps = [&](const glm::vec3& corner) {
    const auto x = static_cast<int32_t>(corner.x * shared::kStepsAPixel);
    const auto y = static_cast<int32_t>(corner.y * shared::kStepsAPixel);
    return glm::ivec2(x - first_x * kSteps - kSteps / 2, y - covered.low.y * kSteps - kSteps / 2);
  };
  const glm::ivec2 a = steps(triangle.a);
  glm::ivec2 b = steps(triangle.b);
  glm::ivec2 c = steps(triangle.c);
  const int32_t area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (area == 0) return;
  if (area < 0) std::swap(b, c);
  Side ab(a, b);
  Side bc(b, c);
  Side ca(c, a);

  const shared::DepthPlane plane = triangle.plane;
  float* depth = bin.depth + (covered.low.y - rect.low.y) * kBinSize + first_x - rect.low.x;
  uint32_t* seen = bin.seen + (depth - bin.depth);
  for (int32_t y = covered.low.y; y < covered.high.y; ++y) {
    const float offset_y = static_cast<float>(y) + 0.5f - plane.corner_gradient.y;
    draw_lanes(
        plane, first_x, covered.high.x - first_x, offset_y,
        [=](int32_t k) { return ab.at(k) | bc.at(k) | ca.at(k); }, depth, seen);
    ab.value += ab.up;
    bc.value += bc.up;
    ca.value += ca.up;
    depth += kBinSize;
    seen += kBinSize;
  }
}

/// One side of a triangle of any size, from its lower to its upper end.
class LongSide {
 public:
  LongSide(const glm::vec3& p, const glm::vec3& q) {
    const bool is_upward = p.y < q.y;
    const glm::dvec2 low(is_upward ? p : q);
    const glm::dvec2 high(is_upward ? q : p);
    const double largest =
        std::max({std::abs(low.x), std::abs(low.y), std::abs(high.x), std::abs(high.y)});
    begin_ = {low.x * kSteps - kSteps / 2, low.y * kSteps - kSteps / 2};
    end_y_ = high.y * kSteps - kSteps / 2;
    way_ = (high - low) * static_cast<double>(kSteps);
    is_exact_ = largest <= static_cast<double>(kExactPixel);
    a_step_ = 1.0 / (way_.y * kSteps);
  }

  /// Whether it crosses the centres of a row of pixels.
  bool crosses(int32_t row) const {
    const double y = static_cast<double>(row) * kSteps;
    return begin_.y <= y && y < end_y_;
  }

  /// The first pixel of a crossed row with its centre not left of the side, clamped to low and
  /// high.
  int32_t first_pixel(int32_t row, int32_t low, int32_t high) const {
    const double y = static_cast<double>(row) * kSteps;
    if (!is_exact_) {
      const double x = (begin_.x + (y - begin_.y) * (way_.x / way_.y)) / kSteps;
      return static_cast<int32_t>(
          std::clamp(std::ceil(x), static_cast<double>(low), static_cast<double>(high)));
    }
    // Rounded up, from an estimate that is off by at most one.
    const int64_t steps_y = static_cast<int64_t>(way_.y);
    const int64_t numerator =
        static_cast<int64_t>(begin_.x) * steps_y +
        (static_cast<int64_t>(y) - static_cast<int64_t>(begin_.y)) * static_cast<int64_t>(way_.x);
    const int64_t denominator = steps_y * kSteps;
    auto pixel = static_cast<int64_t>(static_cast<double>(numerator) * a_step_);
    pixel += pixel * denominator < numerator;
    pixel += pixel * denominator < numerator;
    pixel -= (pixel - 1) * denominator >= numerator;
    return static_cast<int32_t>(
        std::clamp(pixel, static_cast<int64_t>(low), static_cast<int64_t>(high)));
  }

 private:
  /// In steps; pixel centres are at multiples of kSteps.
  glm::dvec2 begin_;
  double end_y_;
  glm::dvec2 way_;
  double a_step_;
  bool is_exact_;
};

/// Rows of a triangle of any size.
class RowSpans {
 public:
  explicit RowSpans(const GridTriangle& triangle)
      : sides_{LongSide(triangle.a, triangle.b), LongSide(triangle.b, triangle.c),
               LongSide(triangle.c, triangle.a)} {}

  /// Its pixels [first, second) in a row, clamped to low and high.
  std::pair<int32_t, int32_t> at(int32_t row, int32_t low, int32_t high) const {
    int32_t first = high;
    int32_t end = low;
    for (const LongSide& side : sides_) {
      if (!side.crosses(row)) continue;
      const int32_t pixel = side.first_pixel(row, low, high);
      first = std::min(first, pixel);
      end = std::max(end, pixel);
    }
    return {first, end};
  }

 private:
  std::array<LongSide, 3> sides_;
};

inline void draw_row(const shared::DepthPlane& plane, int32_t first, int32_t end, int32_t y,
                     const PixelRect& rect, BinPixels& bin) {
  float* depth = bin.depth + (y - rect.low.y) * kBinSize + first - rect.low.x;
  uint32_t* seen = bin.seen + (depth - bin.depth);
  const float offset_y = static_cast<float>(y) + 0.5f - plane.corner_gradient.y;
  const int32_t last = end - first - 1;
  draw_lanes(
      plane, first, end - first, offset_y, [=](int32_t k) { return last - k; }, depth, seen);
}

inline void draw_large(const GridTriangle& triangle, const PixelRect& covered,
                       const PixelRect& rect, BinPixels& bin) {
  const RowSpans spans(triangle);
  const int32_t low = covered.low.x;
  const int32_t high = covered.high.x;
  // If it fills the first and the last row, it fills those between.
  const std::pair<int32_t, int32_t> full(low, high);
  const bool is_full =
      spans.at(covered.low.y, low, high) == full && spans.at(covered.high.y - 1, low, high) == full;
  for (int32_t y = covered.low.y; y < covered.high.y; ++y) {
    const auto [first, end] = is_full ? full : spans.at(y, low, high);
    if (first < end) draw_row(triangle.plane, first, end, y, rect, bin);
  }
}

/// Draws a triangle with an alpha mask.
inline void draw_with_holes(const GridTriangle& triangle, const shared::AlphaTriangle& alpha,
                            const AlphaImages& images, const PixelRect& covered,
                            const PixelRect& rect, BinPixels& bin) {
  const shared::AlphaMaskHeader mask = images.masks[alpha.mask - 1];
  const shared::AlphaPlane image =
      shared::alpha_plane(triangle.a, triangle.b, triangle.c, alpha.uv_a, alpha.uv_b, alpha.uv_c);
  const shared::DepthPlane& plane = triangle.plane;
  const RowSpans spans(triangle);
  for (int32_t y = covered.low.y; y < covered.high.y; ++y) {
    const float offset_y = static_cast<float>(y) + 0.5f - plane.corner_gradient.y;
    const auto [first, end] = spans.at(y, covered.low.x, covered.high.x);
    for (int32_t x = first; x < end; ++x) {
      const float offset_x = static_cast<float>(x) + 0.5f - plane.corner_gradient.x;
      const int32_t at = (y - rect.low.y) * kBinSize + x - rect.low.x;
      const float own = shared::depth_at(offset_x, offset_y, plane.corner_gradient, plane.range);
      if (!(own < bin.depth[at])) continue;
      const uint32_t bit = shared::mask_bit(
          shared::alpha_uv(offset_x, offset_y, image.corner, image.gradient), mask);
      if (bit == shared::kNowhere ||
          shared::is_hole(images.bits[mask.first_word + (bit >> 5)], bit)) {
        continue;
      }
      bin.depth[at] = own;
      bin.seen[at] = plane.seen;
    }
  }
}

bool is_small(const GridTriangle& t) {
  return std::max({t.a.x, t.b.x, t.c.x}) - std::min({t.a.x, t.b.x, t.c.x}) <= kSmall &&
         std::max({t.a.y, t.b.y, t.c.y}) - std::min({t.a.y, t.b.y, t.c.y}) <= kSmall;
}

SNOWBOUGH_KERNEL void draw_all(const OcclusionScene& scene, const DrawList& draws,
                               int64_t first_draw, std::span<const uint32_t> numbers,
                               const PixelRect& rect, BinPixels& bin) {
  DrawList::Cursor cursor(draws);
  for (const uint32_t number : numbers) {
    cursor.move_to(first_draw + number);
    const auto index = static_cast<uint32_t>(cursor.triangle());
    const glm::vec4* corners = &scene.corners[3 * static_cast<size_t>(index)];
    const PixelRect covered = covered_pixels(corners, rect);
    if (covered.empty()) continue;
    const GridTriangle triangle(corners, index);
    if (cursor.range().has_alpha) {
      const shared::AlphaTriangle& alpha =
          scene.alpha
              .triangles[static_cast<size_t>(cursor.triangle() + cursor.range().alpha_offset)];
      if (alpha.mask != 0) {
        draw_with_holes(triangle, alpha, scene.alpha, covered, rect, bin);
        continue;
      }
    }
    if (is_small(triangle)) {
      draw_small(triangle, covered, rect, bin);
    } else {
      draw_large(triangle, covered, rect, bin);
    }
  }
}

}  // namespace

void raster_bin(const OcclusionScene& scene, const DrawList& draws, int64_t first_draw,
                std::span<const uint32_t> numbers, const SeenPixels& pixels, bool is_blank) {
  if (numbers.empty()) {
    if (is_blank) store_nothing(pixels);
    return;
  }
  BinPixels bin;
  clear(bin);
  if (!is_blank) load(pixels, bin);
  draw_all(scene, draws, first_draw, numbers, pixels.rect, bin);
  store(bin, pixels);
}

}  // namespace snowbough::snow::cpu
