#pragma once

#include "render/tree/tree_patches.h"

namespace snowbough::render {

/// Finds for each patch how far its points can stand off the sphere around its corners' mean: out
/// on the limbs' radius, towards the vertices, and by bark. Sampled, with a margin.
void bound_patches(TreePatches& tree);

}  // namespace snowbough::render
