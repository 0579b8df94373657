#pragma once

#include "render/tree/tree_patches.h"

namespace snowbough::render {

/// Computes for each patch how far its points can lie outside the sphere around its corners:
/// because of the limb's round surface, of offsets at the vertices, and of bark. It samples the
/// patch and adds a margin.
void bound_patches(TreePatches& tree);

}  // namespace snowbough::render
