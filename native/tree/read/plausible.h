#pragma once

#include <string>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Why branches that were recognised by shape alone are not a tree; empty if they may be one.
/// Furniture consists of bars: equally thick at both ends, and attached to bars that are no
/// thicker, or straight and all parallel or at right angles. Houses and machines consist of blocks,
/// hardly longer than thick. A tree's limbs taper, or are long and grow on thicker ones. Wood by
/// name, and fewer than four limbs, is accepted.
///
/// @param branches connected, with their parents.
std::string why_no_tree(const std::vector<Branch>& branches);

}  // namespace snowbough::tree
