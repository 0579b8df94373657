#pragma once

#include <cstddef>
#include <vector>

#include "tree/tubes/limb_shape.h"

namespace snowbough::tree {

/// Something along a row of a limb's strip, in samples of their own lengths.
struct RowSamples {
  /// Shares of the row at which samples begin and end, from 0 to 1; one more than there are values.
  std::vector<double> at;
  std::vector<double> values;

  double total() const;
};

/// Radians that a limb's side turns by along a row, by bends and by tapering. Samples are the
/// shorter the more it turns, so that none holds much of a sharp bend beside a long straight
/// stretch.
RowSamples row_turns(const LimbShape& shape, size_t row);

/// Shares at which a row is cut into `count` pieces of the same length.
std::vector<double> even_pieces(int count);

/// Shares at which a row is cut into `count` pieces, so that each holds as much of what is wanted.
std::vector<double> spread_pieces(const RowSamples& wanted, int count);

}  // namespace snowbough::tree
