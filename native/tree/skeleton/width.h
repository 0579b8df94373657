#pragma once

#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Minimum radius of the surface as a fraction of the tree's height: in real exports nearly every
/// tip and some whole branches have no thickness.
inline constexpr float kSmallestRadius = 2e-5f;

enum class WidthMode {
  /// The export's own radii and areas.
  kOriginal,
  /// A flare that decreases as 1 / distance, from the parent's width at the attach point to 0.
  kInverse,
};

enum class Species {
  kBroadleaf,
  /// Thin straight limbs with a short flare on the first level.
  kEvergreen,
};

struct WidthOptions {
  WidthMode mode = WidthMode::kOriginal;
  Species species = Species::kBroadleaf;
  /// Bound X of the inverse width, more than 1: larger values give shorter flares.
  float bound = 4.0f;
  /// The same for the first level of branches of an evergreen.
  float evergreen_bound = 16.0f;
};

/// The limbs' thickness, per branch and point as in the skeleton.
struct Widths {
  /// Metres, at least kSmallestRadius x height.
  std::vector<std::vector<float>> radii;
  /// m2, at least a circle's of the smallest radius; with kInverse a circle's of the radius.
  std::vector<std::vector<float>> areas;
};

/// The inverse width at `t` = 0..1 of the branch's length, for a root width `root`:
/// root * (1 / ((X - 1) t + 1) - 1 / X) / (1 - 1 / X). Equals `root` at 0, and 0 at 1.
///
/// Source: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, eq. 3.3.1 (with the bound
/// subtracted inside the bracket, so that the width does reach both ends).
float inverse_width(float root, float t, float bound);

/// The thickness of every limb. With kInverse a branch's root has its parent's width at the attach
/// point; a root branch has its own radius there, or its largest radius if that is 0.
/// @throws std::invalid_argument for a bound of 1 or less.
Widths limb_widths(const Skeleton& skeleton, const WidthOptions& options);

}  // namespace snowbough::tree
