#pragma once

#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Finds every branch's parent and the place where it sits, and sorts the branches.
///
/// A branch's parent is the branch whose centreline *segment* (not point) is nearest to its root:
/// - with level names (every `level` >= 0): in metres, among the branches of lower levels;
/// - without (every `level` == -1): in radii of the limb there, among thicker branches (larger
///   largest radius; of equals the longer one). Levels are then the depth below the root.
/// A branch that reaches none of these, but another one that does not hang on it (with names: of
/// the same level), takes that; one that reaches none stays a root. Cycles cannot arise.
///
/// "Reaches" means: within three radii of the two limbs and a hundredth of the tree's size. The
/// foot of a second stem beside the first one's foot is not an attachment.
///
/// Branches whose ends look alike are turned round where only their tip touches another limb.
///
/// Afterwards parents come before their children: by level, then in the order of the input.
///
/// @param branches name, level, points, radii and areas filled; receive parent and attach_point.
/// One
///   that comes with a parent (>= 0, an index before it) keeps that and its attach_point.
/// @param reversible per branch: either end may be the root. Sorted along with the branches.
/// @param size largest extent of the tree, in the branches' units.
/// @param progress receives 0..1.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, 3.2.2.
void attach_branches(std::vector<Branch>& branches, std::vector<char>& reversible, float size,
                     const base::Progress& progress = {});

}  // namespace snowbough::tree
