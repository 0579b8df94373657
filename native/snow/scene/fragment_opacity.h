#pragma once

#include <vector>

#include "snow/scene/alpha_mask.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Per fragment of the table: the part of it (0 to 1) that the alpha images keep, sampled at 4 x 4
/// points. Snow falls through the rest, whose area still counts as the texel's. Empty if `alpha`
/// is: the object is opaque.
std::vector<float> fragment_opacity(const TexelTable& table, const MapTopology& topology,
                                    const ObjectAlpha& alpha);

}  // namespace snowbough::snow
