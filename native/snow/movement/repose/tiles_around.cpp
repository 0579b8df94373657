#include "snow/movement/repose/tiles_around.h"

#include <bit>

namespace snowbough::snow {

void mark_around(int32_t blocks_a_side, int32_t block, uint32_t around,
                 std::vector<uint8_t>& marks) {
  const int32_t side = blocks_a_side;
  for (; around != 0; around &= around - 1) {
    const int32_t bit = std::countr_zero(around);
    const int32_t column = block % side + bit % 3 - 1;
    const int32_t row = block / side + bit / 3 - 1;
    if (column < 0 || column >= side || row < 0 || row >= side) continue;
    marks[static_cast<size_t>(row * side + column)] = 1;
  }
}

void activate_cell(const TilesAround& around, int32_t column, int32_t row) {
  const auto activate = [&](int32_t x, int32_t y) {
    const int32_t dx = x < 0 ? -1 : x / kReposeBlock;
    const int32_t dy = y < 0 ? -1 : y / kReposeBlock;
    ReposeTile* const tile = around.at(dx, dy);
    if (tile == nullptr) return;
    tile->links.active_rows.fetch_or(1u << static_cast<uint32_t>(y & (kReposeBlock - 1)),
                                     std::memory_order_relaxed);
  };
  activate(column, row);
  activate(column - 1, row);
  for (int32_t x = column - 1; x <= column + 1; ++x) activate(x, row - 1);
}

void note_bound(const TilesAround& around, int32_t column, int32_t row) {
  for (int32_t dy = -1; dy <= 1; ++dy) {
    for (int32_t dx = -1; dx <= 1; ++dx) {
      const int32_t x = column - dx * kReposeBlock;
      const int32_t y = row - dy * kReposeBlock;
      ReposeTile* const tile = around.at(dx, dy);
      if (tile == nullptr || !TileWindow::has(x, y)) continue;
      const uint64_t row_bit = uint64_t{1} << static_cast<uint32_t>(y);
      if ((tile->outlets.rows_to_pass.load(std::memory_order_relaxed) & row_bit) != 0) continue;
      tile->outlets.rows_to_pass.fetch_or(row_bit, std::memory_order_relaxed);
    }
  }
}

}  // namespace snowbough::snow
