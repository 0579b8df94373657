#pragma once

#include <cstdint>
#include <vector>

#include "snow/movement/press/push.h"

namespace snowbough::snow {

/// The texels under an object.
class CoveredTexels {
 public:
  /// `texels`: ascending, at least one.
  explicit CoveredTexels(const std::vector<int32_t>& texels);
  bool has(int32_t texel) const {
    const auto i = static_cast<size_t>(texel - first_);
    return texel >= first_ && i < has_.size() && has_[i] != 0;
  }

 private:
  int32_t first_ = 0;
  std::vector<uint8_t> has_;
};

/// Piles snow up ahead of a blade that covers texels beside those of `pushed`: where the surface
/// lies lowest under planes that fall away from the blade with `slope`, each over a strip of about
/// twice `width` metres. So the heap keeps its shape while the blade moves, and leaves it at the
/// end that lags behind. Appends the texels that received any.
void pile_ahead(const PressedMap& map, const CoveredTexels& covered,
                const std::vector<PushedSnow>& pushed, double width, double slope,
                std::vector<int32_t>& gains);

}  // namespace snowbough::snow
