#include "tree/uv/strip_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/union_find.h"

namespace snowbough::tree {
namespace {

/// Whether a piece's cells are edge-connected after cutting it open at `seam`.
bool is_connected(const Strip& strip, int32_t first_row, int32_t last_row, int seam) {
  base::UnionFind joined(static_cast<size_t>(last_row - first_row) * kStripSides);
  const auto filled = [&](int32_t row, int column) {
    return !strip.rows[row].cells[(seam + column) % kStripSides].empty();
  };
  int32_t groups = 0;
  for (int32_t row = first_row; row < last_row; ++row) {
    for (int column = 0; column < kStripSides; ++column) {
      if (!filled(row, column)) {
        continue;
      }
      ++groups;
      const int32_t cell = (row - first_row) * kStripSides + column;
      const auto join = [&](int32_t other) {
        groups -= joined.find(cell) != joined.find(other) ? 1 : 0;
        joined.join(cell, other);
      };
      if (column > 0 && filled(row, column - 1)) {
        join(cell - 1);
      }
      if (row > first_row && filled(row - 1, column)) {
        join(cell - kStripSides);
      }
    }
  }
  return groups <= 1;
}

}  // namespace

void cut_strip(const Strip& strip, int32_t strip_index, const std::vector<double>& row_lengths,
               double max_length, std::vector<StripPiece>& pieces) {
  const auto row_count = static_cast<int32_t>(strip.rows.size());
  const auto add_piece = [&](int32_t first, int32_t last) {
    pieces.push_back({strip_index, first, last, first == 0 && strip.root_cap >= 0,
                      last == row_count && strip.tip_cap >= 0});
  };
  for (auto [first, last] : strip.ranges) {
    double rest = std::accumulate(row_lengths.begin() + first, row_lengths.begin() + last, 0.0);
    while (rest > max_length && last - first > 1) {
      const double target = rest / std::ceil(rest / max_length);
      double length = 0.0;
      double best_score = std::numeric_limits<double>::infinity();
      double best_length = 0.0;
      int32_t best_row = first + 1;
      for (int32_t row = first + 1; row < last; ++row) {
        length += row_lengths[row - 1];
        if (length > max_length && row > first + 1) {
          break;
        }
        // Prefers a cut away from a joint if it is about as good, so that a continuing child stays
        // on the same chart.
        const bool joint = strip.rows[row - 1].branch != strip.rows[row].branch;
        const double score = std::abs(length - target) + (joint ? 0.25 * max_length : 0.0);
        if (score < best_score) {
          best_score = score;
          best_row = row;
          best_length = length;
        }
      }
      add_piece(first, best_row);
      first = best_row;
      rest -= best_length;
    }
    add_piece(first, last);
  }
}

int32_t choose_seam(const Strip& strip, const StripPiece& piece) {
  std::array<double, kStripSides> height{};
  for (int32_t row = piece.first_row; row < piece.last_row; ++row) {
    const double width = strip.perimeters[row] + strip.perimeters[row + 1];
    const double length = width > 0.0 ? 2.0 * strip.areas[row] / width : 0.0;
    for (int corner = 0; corner < kStripSides; ++corner) {
      height[corner] +=
          length * (strip.rings[row].heights[corner] + strip.rings[row + 1].heights[corner]);
    }
  }
  std::array<int, kStripSides> order{0, 1, 2, 3};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return height[a] < height[b]; });
  const bool whole =
      std::none_of(strip.rows.begin() + piece.first_row, strip.rows.begin() + piece.last_row,
                   [](const StripRow& row) {
                     return std::any_of(row.cells.begin(), row.cells.end(),
                                        [](const StripCell& cell) { return cell.empty(); });
                   });
  if (whole) {
    return order[0];
  }
  for (const int seam : order) {
    if (is_connected(strip, piece.first_row, piece.last_row, seam)) {
      return seam;
    }
  }
  return order[0];
}

}  // namespace snowbough::tree
