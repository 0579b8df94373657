#pragma once

#include <cstdint>
#include <vector>

#include "snow/movement/repose/links.h"

namespace snowbough::snow {

/// Filters of a receiver's values by texel, over squares of texels up to `radius` rows and columns
/// away, as far as they are linked side by side: the squares do not reach over the borders of
/// charts.
class LinkedRuns {
 public:
  LinkedRuns(const TexelTable& table, const ReposeLinks& links);

  /// The means over the squares.
  void average(int32_t radius, std::vector<float>& values) const;
  /// Distributes each texel's value evenly over its square; the sum stays, up to rounding.
  void spread(int32_t radius, std::vector<float>& values) const;

 private:
  void filter(bool spreads, int32_t radius, std::vector<float>& values) const;
  void find_groups();

  /// The texels column by column; and where runs of linked texels begin, of all texels in their
  /// order, which is row by row, and of `by_column_`; with the end.
  std::vector<int32_t> by_column_;
  std::vector<int32_t> row_begin_, column_begin_;
  /// The first runs of groups of columns that are filtered side by side, with the end.
  std::vector<int32_t> groups_;
};

}  // namespace snowbough::snow
