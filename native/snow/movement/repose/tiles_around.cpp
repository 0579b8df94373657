#include "snow/movement/repose/tiles_around.h"

#include <cmath>

#include "base/simd.h"

namespace snowbough::snow {

namespace {

/// Planes of a block's cells and one cell on every side.
struct Ring {
  static constexpr int32_t kSide = kReposeBlock + 2;
  using Plane = std::array<float, kSide * kSide>;
  Plane x, y, top, gives;

  explicit Ring(const TilesAround& around) {
    for (int32_t row = -1; row <= kReposeBlock; ++row) {
      const int32_t dy = row < 0 ? -1 : row / kReposeBlock;
      const auto inner = static_cast<size_t>((row & (kReposeBlock - 1)) * kReposeBlock);
      const auto first = static_cast<size_t>((row + 1) * kSide);
      copy(around.at(-1, dy), inner + kReposeBlock - 1, first, 1);
      copy(around.at(0, dy), inner, first + 1, kReposeBlock);
      copy(around.at(1, dy), inner, first + 1 + kReposeBlock, 1);
    }
  }

 private:
  void copy(const ReposeTile* tile, size_t from, size_t to, size_t count) {
    if (tile == nullptr) {
      for (Plane* plane : {&x, &y, &top, &gives}) std::fill_n(plane->begin() + to, count, 0.0f);
      return;
    }
    std::copy_n(tile->ground.x.begin() + from, count, x.begin() + to);
    std::copy_n(tile->ground.y.begin() + from, count, y.begin() + to);
    std::copy_n(tile->snow.top.begin() + from, count, top.begin() + to);
    std::copy_n(tile->snow.gives.begin() + from, count, gives.begin() + to);
  }
};

/// Marks the cells of a row beside which snow is higher than `slope` allows; `step`: to the
/// neighbour. Planes begin at the row's first cell.
SNOWBOUGH_WIDE void mark_below(const float* __restrict x, const float* __restrict y,
                               const float* __restrict top, const float* __restrict gives,
                               int32_t step, float slope, int32_t* __restrict marks) {
  const float square = slope * slope;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const float way_x = x[i + step] - x[i];
    const float way_y = y[i + step] - y[i];
    const float over = top[i + step] - top[i];
    const bool is_steep = (over > 0.0f) & (over * over > square * (way_x * way_x + way_y * way_y));
    marks[i] |= (is_steep & (gives[i + step] >= 1.0f)) ? 1 : 0;
  }
}

}  // namespace

std::array<uint32_t, kReposeBlock> cells_below_snow(const TilesAround& around, float slope) {
  const Ring ring(around);
  std::array<uint32_t, kReposeBlock> below{};
  for (int32_t row = 0; row < kReposeBlock; ++row) {
    std::array<int32_t, kReposeBlock> marks{};
    const auto first = static_cast<size_t>((row + 1) * Ring::kSide + 1);
    for (const int32_t step : {1, -1, Ring::kSide, -Ring::kSide, Ring::kSide + 1, Ring::kSide - 1,
                               -Ring::kSide + 1, -Ring::kSide - 1}) {
      mark_below(&ring.x[first], &ring.y[first], &ring.top[first], &ring.gives[first], step, slope,
                 marks.data());
    }
    for (uint32_t i = 0; i < kReposeBlock; ++i) {
      below[static_cast<size_t>(row)] |= static_cast<uint32_t>(marks[i]) << i;
    }
  }
  return below;
}

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
