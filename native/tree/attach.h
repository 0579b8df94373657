#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tree/skeleton.h"

namespace snowbough::tree {

/// Finds every branch's parent and the place where it sits, and sorts the branches.
///
/// A branch's parent is the branch whose centreline *segment* (not point) is nearest to its root:
/// - with level names (every `level` >= 0): in metres, among the branches of lower levels;
/// - without (every `level` == -1): in radii of the limb there, among thicker branches (larger
/// largest
///   radius; of equals the longer one). Levels are then the depth below the root.
/// Parents are always thicker or of a lower level, so that no cycle can arise. A branch that
/// reaches no such branch, but another one that does not hang on it, takes that; one that reaches
/// none stays a root.
///
/// "Reaches" means: within three radii of the two limbs and a hundredth of the tree's size. The
/// foot of a second stem beside the first one's foot is not an attachment.
///
/// Afterwards parents come before their children: by level, then in the order of the input.
///
/// @param branches name, level, points, radii and areas filled; parent and attach_point are set
/// here.
/// @param size largest extent of the tree, in the branches' units.
/// @return names of the branches that stayed roots although they are not the first one.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, 3.2.2.
std::vector<std::string> attach_branches(std::vector<Branch>& branches, float size);

}  // namespace snowbough::tree
