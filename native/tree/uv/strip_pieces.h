#pragma once

#include <cstdint>
#include <vector>

#include "tree/uv/strip_rows.h"

namespace snowbough::tree {

/// Part of a strip that becomes one chart: rows [first_row, last_row) cut open along one corner.
struct StripPiece {
  int32_t strip = 0;
  int32_t first_row = 0;
  int32_t last_row = 0;
  bool has_root_cap = false;
  bool has_tip_cap = false;
};

/// Cuts every range of a strip into as few pieces of similar length as possible, none longer than
/// `max_length` unless it is a single row, and adds them to `pieces`.
/// @param row_lengths  one entry per row, in the unit of max_length.
void cut_strip(const Strip& strip, int32_t strip_index, const std::vector<double>& row_lengths,
               double max_length, std::vector<StripPiece>& pieces);

/// Corner along which a piece is cut open: the lowest one, weighted by length, that leaves its
/// cells connected; otherwise the lowest one.
int32_t choose_seam(const Strip& strip, const StripPiece& piece);

}  // namespace snowbough::tree
