#pragma once

#include <cstdint>
#include <vector>

#include "snow/seams/seam_row.h"

namespace snowbough::snow {

/// Approximates the solution of SeamFactor::solve if the factor would be too large: `rounds` steps
/// of the conjugate gradient method, which needs only the rows. The same input gives the same bits.
/// M. R. Hestenes, E. Stiefel, Methods of Conjugate Gradients for Solving Linear Systems, 1952.
///
/// `rows`, `damping` and `values` as for SeamFactor; sources are less than `sources`.
void solve_by_gradients(const std::vector<SeamRow>& rows, int32_t sources, float damping,
                        int32_t rounds, std::vector<float>& values);

}  // namespace snowbough::snow
