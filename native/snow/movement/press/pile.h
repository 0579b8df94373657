#pragma once

#include <cstdint>
#include <vector>

#include "snow/movement/press/push.h"

namespace snowbough::snow {

/// Piles snow up ahead of a blade: where the surface
/// lies lowest under planes that fall away from the blade with `slope`, each over a strip of about
/// twice `width` metres. So the heap keeps its shape while the blade moves, and leaves it at the
/// end that lags behind. Appends the texels that received any.
void pile_ahead(const PressedMap& map, const std::vector<PushedSnow>& pushed, double width,
                double slope, std::vector<int32_t>& gains);

}  // namespace snowbough::snow
