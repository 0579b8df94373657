#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "shaders/lib/snow_shared.h"

namespace snowbough::snow {

/// A box in world space, metres; empty while low > high.
struct Bounds {
  glm::dvec3 low{1e300};
  glm::dvec3 high{-1e300};
  bool empty() const { return low.x > high.x; }
  void include(const glm::dvec3& point);
  void include(const Bounds& other);
};

/// Half-open rectangle of local pixels.
struct PixelRect {
  glm::ivec2 low{0};
  glm::ivec2 high{0};
  glm::ivec2 size() const { return high - low; }
  bool empty() const { return low.x >= high.x || low.y >= high.y; }
};

/// A part of the grid that is rendered at once.
struct Tile {
  PixelRect pixels;
  /// Lower left corner of the viewport in local pixels. All tiles of a block share it, so that a
  /// triangle is clipped in the same way for every tile size.
  glm::ivec2 viewport_origin{0};

  /// The rendered pixels: the tile's own and the margin that points at its edge sample.
  PixelRect with_margin() const {
    return {pixels.low - shared::kTileMargin, pixels.high + shared::kTileMargin};
  }
};

/// Snowfall of one step.
struct FallSettings {
  /// Unit vector of the mean fall direction.
  glm::dvec3 direction{0.0, 0.0, -1.0};
  double pixel_size = 0.01;
  /// Half the opening angle of the cone of directions, in radians; see flutter_direction.
  double flutter = 0.0;
  double noise_density = 1.0;
  /// Depth in metres on open level ground.
  double depth = 0.0;
  uint32_t seed = 0;
  uint32_t step_number = 0;
};

/// Width of the viewport in pixels, and of a block: the viewport is a block with a margin of half a
/// block.
inline constexpr int32_t kViewportSize = 16384;
inline constexpr int32_t kBlockSize = 8192;
/// Largest edge of a tile.
inline constexpr int32_t kLargestTile = 4096;
static_assert(kLargestTile <= kBlockSize);

/// The fall direction of one step: `direction` turned within the cone of `flutter`. Every 64 steps
/// form a sunflower pattern, the most even distribution of 64 points from every side, so that a
/// straight shadow's edge becomes an even slope without terraces. The cone is narrowed so that it
/// stays within 89.5 degrees of vertical if `direction` does.
/// Source: H. Vogel, A Better Way to Construct the Sunflower Head, 1979.
glm::dvec3 flutter_direction(const glm::dvec3& direction, double flutter, uint32_t seed,
                             uint32_t step_number);

/// Sub-pixel offset of the grid in a step, in [0, 1): the R2 sequence, shifted by the seed.
/// Source: M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018.
glm::dvec2 grid_jitter(uint32_t seed, uint32_t step_number);

/// Position in its cell, in [0, 1), of the sample of a texel that is much larger than a pixel:
/// uniform, by seed and step.
glm::dvec2 sample_shift(uint32_t seed, uint32_t step_number);

/// Builds the frame for the shaders: the grid is perpendicular to the (fluttering) fall and
/// anchored at the world's origin; `scene` bounds all objects.
shared::ProjectionFrame make_projection_frame(const FallSettings& settings, const Bounds& scene);

/// The local pixels that may show a part of `bounds`, plus one pixel.
PixelRect pixels_of(const Bounds& bounds, const shared::ProjectionFrame& frame);

/// Divides the pixels of all receivers into tiles of at most `tile_size` pixels a side; tiles
/// without a receiver are left out.
/// @throws std::invalid_argument with advice if the grid would be wider than 65,536 pixels.
std::vector<Tile> make_tiles(const std::vector<PixelRect>& receivers, int32_t tile_size);

}  // namespace snowbough::snow
