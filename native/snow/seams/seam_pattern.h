#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "snow/seams/seam_row.h"

namespace snowbough::snow {

/// Sparsity pattern, above the diagonal and column by column, of the normal matrices of problems
/// over the same rows, and the entry of each product of two of a row's weights. It is computed
/// once; every matrix is then summed without a search.
class SeamPattern {
 public:
  /// `rows`: sources ascend; those from `unknowns` on are padding. Keeps no reference to them.
  SeamPattern(const std::vector<SeamRow>& rows, int32_t unknowns);

  int32_t unknowns() const { return static_cast<int32_t>(begin_.size()) - 1; }
  /// Entries of column j: [begin(j), begin(j + 1)).
  int32_t begin(int32_t column) const { return begin_[static_cast<size_t>(column)]; }
  /// The unknown of an entry's row.
  int32_t row(int32_t entry) const { return row_[static_cast<size_t>(entry)]; }
  int32_t entries() const { return begin_.back(); }
  /// Offsets from their column's beginning of the products of row r's weights: of terms b and a < b
  /// at b (b - 1) / 2 + a.
  const uint16_t* offsets(int32_t r) const {
    return offset_.data() + static_cast<size_t>(r) * kPairs;
  }
  /// False if a column has more entries than an offset can hold.
  bool is_complete() const { return is_complete_; }

  int64_t bytes() const;

 private:
  static constexpr size_t kPairs = size_t{kSeamTerms} * (kSeamTerms - 1) / 2;
  static constexpr int32_t kMaxOffset = std::numeric_limits<uint16_t>::max();

  std::vector<int32_t> begin_{0};
  std::vector<int32_t> row_;
  std::vector<uint16_t> offset_;
  bool is_complete_ = true;
};

}  // namespace snowbough::snow
