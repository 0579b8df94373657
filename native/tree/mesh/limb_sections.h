#pragma once

#include <vector>

#include "tree/skeleton/tree_mesh.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// The sections of all limbs, branch by branch: one per row of a branch's strip.
std::vector<LimbSection> limb_sections(const Surface& surface);

}  // namespace snowbough::tree
