#pragma once

#include <array>
#include <cstdint>

namespace snowbough::snow {

/// Number of terms: two sides of a seam, each interpolated between four texels.
inline constexpr int32_t kSeamTerms = 8;

/// One equation of a least-squares problem: a sum of weight * unknown. Sources ascend; sources from
/// the number of unknowns on are padding.
struct SeamRow {
  std::array<int32_t, kSeamTerms> source{};
  std::array<float, kSeamTerms> weight{};
};

}  // namespace snowbough::snow
