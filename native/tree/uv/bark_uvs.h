#pragma once

#include <vector>

#include "tree/skeleton/tree_mesh.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Tiling texture coordinates, per quad corner: u runs once around every limb, v grows along it by
/// length over circumference, so that a bark texture keeps its aspect from trunk to twig. A child
/// that continues its parent starts at the parent's last v; others at 0. Caps show the texture at
/// their ring's scale.
std::vector<QuadUv> layout_bark_uvs(const Surface& surface);

}  // namespace snowbough::tree
