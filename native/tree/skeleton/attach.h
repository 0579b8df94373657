#pragma once

#include <vector>

#include "base/progress.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Finds every branch's parent and attach point, and sorts the branches.
///
/// A branch's parent is the branch whose centreline *segment* (not point) is nearest to its root:
/// - with level names (every `level` >= 0): in metres, among the branches of lower levels;
/// - without (every `level` == -1): in radii of the limb there, among thicker branches (larger
///   maximum radius; on a tie the longer one), or that one's parent if the branch starts inside it.
///   Levels are then the depth below the root.
/// A branch out of reach of all of these takes one that does not descend from it (with names: of
/// lower levels within twice the reach, else of the same level); one out of reach of all branches
/// stays a root. No cycles arise.
///
/// "In reach" means within three radii of the two limbs and a hundredth of the tree's size. The
/// base of a second stem beside the first one's base is not an attachment.
///
/// Branches with similar ends are reversed if only their tip touches another limb.
///
/// Afterwards parents come before their children: by level, then in input order.
///
/// @param branches with name, level, points, radii and areas; receive parent and attach_point. A
///   branch that already has a parent (>= 0, an index before it) keeps it and its attach_point.
/// @param reversible per branch: either end may be the root. Sorted along with the branches.
/// @param size largest extent of the tree, in the branches' units.
/// @param progress receives 0..1.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, 3.2.2.
void attach_branches(std::vector<Branch>& branches, std::vector<char>& reversible, float size,
                     const base::Progress& progress = {});

}  // namespace snowbough::tree
