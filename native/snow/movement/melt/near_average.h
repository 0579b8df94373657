#pragma once

#include <cstdint>
#include <vector>

#include "snow/movement/repose/links.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// By texel, the mean of `values` over a square of texels up to `radius` rows and columns away, as
/// far as they are linked side by side: the square does not reach over the borders of charts.
std::vector<float> near_average(const TexelTable& table, const ReposeLinks& links, int32_t radius,
                                std::vector<float> values);

}  // namespace snowbough::snow
