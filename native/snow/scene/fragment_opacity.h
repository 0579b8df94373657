#pragma once

#include <vector>

#include "snow/scene/alpha_mask.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Per fragment of the table: which part of it (0 to 1) the alpha images leave, looked up at 4 x 4
/// points. What falls on the rest falls through; its area counts as the texel's all the same.
/// Empty where `alpha` is: the object is opaque.
std::vector<float> fragment_opacity(const TexelTable& table, const MapTopology& topology,
                                    const ObjectAlpha& alpha);

}  // namespace snowbough::snow
