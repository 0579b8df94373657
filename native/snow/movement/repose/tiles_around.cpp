#include "snow/movement/repose/tiles_around.h"

namespace snowbough::snow {

std::array<uint32_t, kReposeBlock> rows_near_snow(const TilesAround& around) {
  // Snow that flows into a shelter advances less in a step.
  constexpr int kNear = 3;
  // Bit i: column i - 1; row i: row i - 1.
  std::array<uint64_t, kReposeBlock + 2> snow{};
  for (int32_t row = -1; row <= kReposeBlock; ++row) {
    const int32_t dy = row < 0 ? -1 : row / kReposeBlock;
    for (int32_t dx = -1; dx <= 1; ++dx) {
      const ReposeTile* const tile = around.at(dx, dy);
      if (tile == nullptr || tile->snow.is_bare) continue;
      const float* const held =
          tile->snow.held.data() + static_cast<size_t>((row & (kReposeBlock - 1)) * kReposeBlock);
      uint64_t bits = 0;
      for (uint32_t i = 0; i < kReposeBlock; ++i) {
        bits |= static_cast<uint64_t>(held[i] > 0.0f ? 1 : 0) << i;
      }
      uint64_t& own = snow[static_cast<size_t>(row + 1)];
      own |= dx == 0 ? bits << 1 : dx < 0 ? bits >> 31 : (bits & 1) << 33;
    }
  }
  std::array<uint32_t, kReposeBlock> near{};
  for (int32_t row = 0; row < kReposeBlock; ++row) {
    uint64_t bits = 0;
    const int32_t first = std::max(row + 1 - kNear, 0);
    const int32_t last = std::min(row + 1 + kNear, kReposeBlock + 1);
    for (int32_t other = first; other <= last; ++other) bits |= snow[static_cast<size_t>(other)];
    for (int i = 0; i < kNear; ++i) bits |= bits << 1 | bits >> 1;
    near[static_cast<size_t>(row)] = static_cast<uint32_t>(bits >> 1);
  }
  return near;
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
