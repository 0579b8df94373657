#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "shaders/lib/snow_shared.h"
#include "snow/scene/projection.h"

namespace snowbough::snow::cpu {

/// What all samples of a run see of the sky.
enum class RunVisibility {
  /// All of it: seen_part (shaders/lib/visibility.h) of each is 1.
  kOpen,
  /// Nothing: of each it is 0.
  kHidden,
  /// They lie in other tiles.
  kElsewhere,
  /// They differ, or are too close to call; all lie in this tile.
  kMixed,
  /// Nothing is known, not even whether all lie in this tile.
  kUnknown,
};

/// The part of a triangle in which the samples of a run lie.
struct RunPlane {
  /// Corner, and from there to the others: local pixels and metres of depth, as in a GainTriangle.
  glm::vec3 corner;
  glm::vec3 edge_b;
  glm::vec3 edge_c;
  /// Depth that the plane gains in one pixel along each axis.
  glm::vec2 gradient;
  /// Metres of depth by which a pixel may lie in front of the plane and still be open, and beyond
  /// which it hides what lies there whatever it shows.
  float depth_bias;
  float reach;
  /// Between which the samples lie: weights of the second and third corner, and their sums.
  float least_b, most_b;
  float least_c, most_c;
  float least_sum, most_sum;
};

/// Tells what all samples of a run see, by looking once at each of the pixels around them. `seen`
/// shows the tile and its margin, row by row, and kSeenSpare pixels more.
///
/// The samples' own arithmetic is in floats. This one is in doubles and leaves their roundings to
/// spare, so that what it tells is what each sample would find, to the bit, where all pixels give
/// snow.
RunVisibility visibility_of(const RunPlane& plane, const Tile& tile, const shared::SeenPixel* seen);

/// What loops over whole vectors may read behind the last pixel.
inline constexpr size_t kSeenSpare = 8;

}  // namespace snowbough::snow::cpu
