#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "shaders/lib/snow_shared.h"
#include "snow/scene/projection.h"

namespace snowbough::snow::cpu {

/// How much of the sky the samples of a run see.
enum class RunVisibility {
  /// All of it: seen_part (shaders/lib/visibility.h) of each sample is 1.
  kOpen,
  /// None: seen_part of each sample is 0.
  kHidden,
  /// All samples lie in other tiles.
  kElsewhere,
  /// The samples differ, or are too close to decide; all lie in this tile.
  kMixed,
  /// Unknown, including whether all samples lie in this tile.
  kUnknown,
};

/// The part of a triangle that contains the samples of a run.
struct RunPlane {
  /// First corner and the edges to the others: local pixels and metres of depth, as in a
  /// GainTriangle.
  glm::vec3 corner;
  glm::vec3 edge_b;
  glm::vec3 edge_c;
  /// Depth change of the plane per pixel along each axis.
  glm::vec2 gradient;
  /// Depths in metres: a pixel up to `depth_bias` in front of the plane is still open; beyond
  /// `reach` it hides the sample whatever surface it shows.
  float depth_bias;
  float reach;
  /// Bounds of the samples: weights of the second and third corner, and their sums.
  float least_b, most_b;
  float least_c, most_c;
  float least_sum, most_sum;
};

/// Finds how much of the sky all samples of a run see, by reading each of the pixels around them
/// once. `seen` shows the tile and its margin, row by row, plus kSeenSpare pixels.
/// The samples' own arithmetic is in floats. This function uses doubles and leaves margin for their
/// rounding, so that its result is exactly each sample's, provided that all pixels give snow.
/// Without it, a bake of ground with texels four times as wide as pixels takes 1.7 times as long;
/// with texels as wide as pixels, as long or 4 to 10 % longer.
RunVisibility visibility_of(const RunPlane& plane, const Tile& tile, const shared::SeenPixel* seen);

/// Elements that vectorised loops may read behind the last pixel.
inline constexpr size_t kSeenSpare = 8;

}  // namespace snowbough::snow::cpu
