#pragma once

#include <cstddef>
#include <vector>

#include "tree/tubes/limb_shape.h"

namespace snowbough::tree {

/// A quantity along a row of a limb's strip, in samples of different lengths.
struct RowSamples {
  /// Bounds of the samples as fractions of the row, from 0 to 1; one more than values.
  std::vector<double> at;
  std::vector<double> values;

  double total() const;
};

/// Turn in radians of a limb's side along a row, from bends and tapering. Samples are shorter where
/// it turns more, so that none combines a sharp bend with a long straight stretch.
RowSamples row_turns(const LimbShape& shape, size_t row);

/// Bounds, as fractions of a row, of `count` pieces of equal length.
std::vector<double> even_pieces(int count);

/// Bounds, as fractions of a row, of `count` pieces with equal amounts of the quantity.
std::vector<double> spread_pieces(const RowSamples& wanted, int count);

}  // namespace snowbough::tree
