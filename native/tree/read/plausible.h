#pragma once

#include <string>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Why branches that were found by their shape alone are no tree; empty where they may be one.
/// Furniture is made of bars: as thick at one end as at the other, and standing on others that are
/// no thicker, or straight and all parallel or at right angles. Houses and machines are made of
/// blocks, hardly longer than they are thick. A tree's limbs taper, or are long and stand on
/// thicker ones. What is named as wood, or is fewer than four limbs, is not doubted.
///
/// @param branches connected, with their parents.
std::string why_no_tree(const std::vector<Branch>& branches);

}  // namespace snowbough::tree
