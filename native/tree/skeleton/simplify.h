#pragma once

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

enum class Simplify {
  /// Keeps every point.
  kNone,
  /// A branch with children keeps its root and its children's attach points, joined by straight
  /// bones, and ends at its last child. A branch without children keeps every point. (If all
  /// children sit at its root it keeps its tip too, since it needs a bone.)
  kThesis,
  /// As kThesis, plus the points needed to keep the limb, including the end beyond the last child,
  /// within `tolerance` x local radius of the original: the distance between the centrelines
  /// combined with the difference of the radii, so that flares on straight limbs are kept. Repeated
  /// bulges, such as a palm's rings, are kept from a twentieth of the tolerance on.
  kTolerance,
};

/// @throws std::invalid_argument for a tolerance that is negative or not finite.
void check_tolerance(float tolerance);

/// Simplifies the centrelines in place. Afterwards every attach point of a simplified branch is one
/// of its points, with interpolated radius and area. Branches and parents keep their indices.
///
/// @param tolerance for kTolerance, in local radii, at least 0. A limb without thickness counts as
///   kSmallestRadius of the height thick (width.h).
/// @throws std::invalid_argument as check_tolerance.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, 3.2.3; intermediate points
/// are selected after D. H. Douglas and T. K. Peucker, The Canadian Cartographer 10(2), 1973, with
/// the radius as a further coordinate.
void simplify_skeleton(Skeleton& skeleton, Simplify mode, float tolerance);

}  // namespace snowbough::tree
