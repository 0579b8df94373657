#pragma once

#include <cstdint>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Divides a kept surface, attached to its branches, into charts: per polygon its chart, counted
/// from 0. A chart grows from its first polygon over edges to polygons of the same branch that face
/// nearly the same way, within a third of the surface's size, so that it can be projected flat.
std::vector<int32_t> grow_charts(const KeptSurface& kept);

}  // namespace snowbough::tree
