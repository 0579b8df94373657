#pragma once

#include <cstdint>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// The order of a receiver's texels on the GPU, as indices into the table: chart by chart, and
/// within a chart by squares of 32 x 32 texels. Neighbours on the surface then share a work group,
/// and whole groups turn away from the fall together (see step/gl/passes.h). Within a work group,
/// texels with one fragment come first, then those with two, and so on. O(texels).
std::vector<int32_t> texel_order(const TexelTable& table);

}  // namespace snowbough::snow
