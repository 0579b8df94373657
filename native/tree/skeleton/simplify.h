#pragma once

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

enum class Simplify {
  /// Every point stays.
  kNone,
  /// A branch with children keeps its root and its children's attach points, joined by straight
  /// bones, and ends at its last child. A branch without children keeps every point. (One whose
  /// children all sit at its root keeps its tip too, since it needs a bone.)
  kThesis,
  /// As kThesis, and the points that are needed so that nowhere, the end beyond the last child
  /// included, the limb lies farther than `tolerance` x local radius from the original one: the
  /// distance between their centrelines and the difference of their radii together, so that a flare
  /// stays a flare on a straight limb.
  kTolerance,
};

/// @throws std::invalid_argument for a tolerance that is negative or not finite.
void check_tolerance(float tolerance);

/// Thins out the centrelines in place. Afterwards every attach point of a branch that was thinned
/// is one of its points; radii and areas there are interpolated. Branches and parents keep their
/// numbers.
///
/// @param tolerance for kTolerance, in local radii, at least 0. Where a limb has no thickness its
///   radius counts as kSmallestRadius of the height (width.h).
/// @throws std::invalid_argument as check_tolerance.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, 3.2.3; the points between
/// are chosen after D. H. Douglas and T. K. Peucker, The Canadian Cartographer 10(2), 1973, with
/// the radius as a further coordinate.
void simplify_skeleton(Skeleton& skeleton, Simplify mode, float tolerance);

}  // namespace snowbough::tree
