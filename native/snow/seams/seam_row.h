#pragma once

#include <array>
#include <cstdint>

namespace snowbough::snow {

/// Two sides of a seam, each read between four texels.
inline constexpr int32_t kSeamTerms = 8;

/// One equation of a least-squares problem: a sum of weight * unknown. Sources ascend; those from
/// the number of unknowns on are none, and so fill up a row that has fewer terms.
struct SeamRow {
  std::array<int32_t, kSeamTerms> source{};
  std::array<float, kSeamTerms> weight{};
};

}  // namespace snowbough::snow
