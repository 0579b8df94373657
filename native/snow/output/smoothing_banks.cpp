// Smoother's banks: where snow ends in a slope on ground that goes on, it is spread the less the
// nearer the foot of the slope is.
#include <algorithm>
#include <array>
#include <cmath>

#include "snow/output/smoothing.h"
#include "snow/output/smoothing_kernels.h"

namespace snowbough::snow {
namespace {

/// Distances are noted in parts of a cell; a diagonal step is 1.4 cells long.
constexpr int32_t kSteps = 8;
constexpr int32_t kDiagonal = 11;
constexpr auto kFarthest = static_cast<int32_t>(kBankCells * kSteps);

constexpr uint8_t kRidgeBit = 128;
constexpr uint8_t kDistanceBits = 127;
static_assert(kFarthest <= kDistanceBits);

/// Cells by their distance; visit() calls with the nearest first, those that it adds included, and
/// visit_back() with the farthest first.
class Buckets {
 public:
  void add(int32_t cell, int32_t distance) {
    cells_[static_cast<size_t>(distance)].push_back(cell);
  }

  template <typename Visit>
  void visit(const Visit& visit) {
    for (size_t distance = 0; distance < cells_.size(); ++distance) {
      for (size_t i = 0; i < cells_[distance].size(); ++i) {
        visit(cells_[distance][i], static_cast<int32_t>(distance));
      }
    }
  }

  template <typename Visit>
  void visit_back(const Visit& visit) const {
    for (size_t distance = cells_.size(); distance-- > 0;) {
      for (const int32_t cell : cells_[distance]) visit(cell, static_cast<int32_t>(distance));
    }
  }

 private:
  std::array<std::vector<int32_t>, static_cast<size_t>(kFarthest) + 1> cells_;
};

/// A block's first cell on the level below, and the three beside and above it.
std::array<int32_t, 4> cells_of_block(int32_t block, int32_t size, int32_t fine_size) {
  const int32_t first = block / size * 2 * fine_size + block % size * 2;
  return {first, first + 1, first + fine_size, first + fine_size + 1};
}

}  // namespace

/// Finds the cells of level 0 in which a bank ends, and those near them.
void Smoother::find_banks(const EdgeArrays& edges) {
  Level& level = levels_[0];
  const SmoothingLevel& grid = grid_.levels[0];
  const float* const height = level.at(level.height);
  const ClosenessView closeness{grid.to_right(), grid.upwards(), grid.size};
  // Cells that snow rises per cell, towards the one side where it ends on the other.
  const auto rise = [&](int32_t i, ptrdiff_t step, const uint16_t* links) {
    float most = 0.0f;
    for (const ptrdiff_t inwards : {step, -step}) {
      const uint16_t up = links[inwards > 0 ? i : i - step];
      const uint16_t down = links[inwards > 0 ? i - step : i];
      if (down != 0 && is_open(height[i], height[i - inwards])) continue;
      const float more = std::fabs(height[i + inwards]) - std::fabs(height[i]);
      most = std::max(most, more * std::sqrt(from_half(up)));
    }
    return most;
  };
  const auto is_foot = [&](int32_t i) {
    if (height[i] == 0.0f || grid_.end[i] == SurfaceEnd::kRim) return false;
    if (edges.distance[i] != 0 && grid_.end[i] != SurfaceEnd::kOpen) return false;
    if (std::fabs(height[i]) * std::sqrt(closest_link(closeness, i)) > kHighestFoot) return false;
    const float along = rise(i, 1, closeness.right);
    const float across = rise(i, closeness.size, closeness.above);
    return along * along + across * across > kLeastBank * kLeastBank;
  };
  std::vector<std::vector<int32_t>> feet(static_cast<size_t>(band_count(grid)));
  for_each_row_band(grid, [&](size_t band, int32_t first, int32_t last) {
    for (int32_t r = level.run_row[first]; r < level.run_row[last]; ++r) {
      for (int32_t i = level.runs[r].begin; i < level.runs[r].end; ++i) {
        if (is_foot(i)) feet[band].push_back(i);
      }
    }
  });
  for (const std::vector<int32_t>& cells : feet) {
    for (const int32_t cell : cells) {
      level.bank.distance.data()[level.margin + cell] = kSteps / 2;
      level.bank.cells.push_back(cell);
    }
  }
  spread_bank(0);
}

/// Calls visit(neighbour, step) for the cells around one to which snow of a level reaches.
template <typename Visit>
void Smoother::for_each_beside(size_t number, int32_t i, const Visit& visit) const {
  const SmoothingLevel& grid = grid_.levels[number];
  const uint16_t* const right = grid.to_right();
  const uint16_t* const above = grid.upwards();
  const int32_t size = grid.size;
  const auto visit_beside = [&](int32_t j) {
    visit(j, kSteps);
    if (above[j] != 0) visit(j + size, kDiagonal);
    if (above[j - size] != 0) visit(j - size, kDiagonal);
  };
  if (right[i] != 0) visit_beside(i + 1);
  if (right[i - 1] != 0) visit_beside(i - 1);
  if (above[i] != 0) visit(i + size, kSteps);
  if (above[i - size] != 0) visit(i - size, kSteps);
  // On level 0 links that run elsewhere take the place of those on the grid.
  const bool is_inner = right[i] != 0 && right[i - 1] != 0 && above[i] != 0 && above[i - size] != 0;
  if (number == 0 && is_inner) return;
  const auto cells = grid.link_cell.begin();
  const int32_t row = i / size;
  const auto end = cells + grid.link_row[row + 1];
  const auto at = std::lower_bound(cells + grid.link_row[row], end, i);
  if (at == end || *at != i) return;
  const auto k = static_cast<size_t>(at - cells);
  for (int32_t t = grid.link_begin[k]; t < grid.link_begin[k + 1]; ++t) {
    visit(grid.link_other[t], kSteps);
  }
}

/// Goes on from the feet of a level to all cells that are near enough, and forgets ridges again.
void Smoother::spread_bank(size_t number) {
  Level& level = levels_[number];
  const float* const height = level.at(level.height);
  const SmoothingLevel& grid = grid_.levels[number];
  const ClosenessView closeness{grid.to_right(), grid.upwards(), grid.size};
  uint8_t* const distance = level.bank.distance.data() + level.margin;
  Buckets buckets;
  for (const int32_t cell : level.bank.cells) buckets.add(cell, distance[cell]);
  buckets.visit([&](int32_t i, int32_t from) {
    if (distance[i] != from) return;  // reached on a shorter way since
    for_each_beside(number, i, [&](int32_t j, int32_t step) {
      const int32_t to = from + step;
      if (to > kFarthest || height[i] * height[j] <= 0.0f) return;
      if (distance[j] != 0 && distance[j] <= to) return;
      if (distance[j] == 0) level.bank.cells.push_back(j);
      distance[j] = static_cast<uint8_t>(to);
      buckets.add(j, to);
    });
  });
  // A ridge is all bank: its crest is the farthest from its feet and still steeply above them. It
  // is rounded as ever, or posts and twigs would wear tents.
  buckets.visit_back([&](int32_t i, int32_t at) {
    if (distance[i] != at) return;
    int32_t farthest = at;
    const float cells_high = std::fabs(height[i]) * std::sqrt(closest_link(closeness, i));
    bool is_ridge = cells_high * kSteps > kLeastBank * static_cast<float>(at);
    for_each_beside(number, i, [&](int32_t j, int32_t) {
      if (height[i] * height[j] <= 0.0f) return;
      const int32_t there = distance[j] == 0 ? kFarthest + 1 : distance[j] & kDistanceBits;
      if (there <= farthest) return;
      farthest = there;
      is_ridge = (distance[j] & kRidgeBit) != 0;
    });
    if (is_ridge) distance[i] |= kRidgeBit;
  });
  std::erase_if(level.bank.cells, [&](int32_t cell) {
    const bool is_ridge = (distance[cell] & kRidgeBit) != 0;
    if (is_ridge) distance[cell] = 0;
    return is_ridge;
  });
}

/// Fills a level's bank from the one below: a block is half as many cells away as the nearest of
/// its cells.
void Smoother::restrict_bank(size_t number) {
  const Level& fine = levels_[number - 1];
  Level& level = levels_[number];
  const SmoothingLevel& fine_grid = grid_.levels[number - 1];
  const int32_t size = grid_.levels[number].size;
  const uint8_t* const from = fine.bank.distance.data() + fine.margin;
  uint8_t* const to = level.bank.distance.data() + level.margin;
  for (const int32_t cell : fine.bank.cells) {
    if (fine_grid.joins[cell] == 0) continue;
    const int32_t block = cell / fine_grid.size / 2 * size + cell % fine_grid.size / 2;
    const auto distance = static_cast<uint8_t>(from[cell] / 2 + kSteps / 4);
    if (to[block] == 0) level.bank.cells.push_back(block);
    if (to[block] == 0 || distance < to[block]) to[block] = distance;
  }
  spread_bank(number);
}

float Smoother::cells_to_foot(size_t number, int32_t cell) const {
  const Level& level = levels_[number];
  const uint8_t distance = level.bank.distance.data()[level.margin + cell];
  return distance == 0 ? kBankCells : static_cast<float>(distance) / kSteps;
}

/// Takes from a level's conductances what banks do not let through.
void Smoother::limit_bank(size_t number) {
  Level& level = levels_[number];
  if (level.bank.cells.empty()) return;
  const SmoothingLevel& grid = grid_.levels[number];
  const float* const inverse = level.at(level.inverse_weight);
  const auto limited = [&](int32_t i, int32_t j, float closeness, float conductance) {
    const float cells = 0.5f * (cells_to_foot(number, i) + cells_to_foot(number, j));
    const float most = std::max(bank_limit(cells), 0.5f * least_variance_ * closeness);
    const float own = std::max(most - done_below_[number], 0.0f);
    return std::min(conductance, own / (kStages * std::max(inverse[i], inverse[j])));
  };
  float* const right = level.at(level.right);
  float* const above = level.at(level.above);
  const uint8_t* const distance = level.bank.distance.data() + level.margin;
  for_each_run(number, [&](int32_t, Run run) {
    for (int32_t i = run.begin; i < run.end; ++i) {
      if ((distance[i] | distance[i + 1]) != 0 && right[i] != 0.0f) {
        right[i] = limited(i, i + 1, from_half(grid.to_right()[i]), right[i]);
      }
      if ((distance[i] | distance[i + grid.size]) != 0 && above[i] != 0.0f) {
        above[i] = limited(i, i + grid.size, from_half(grid.upwards()[i]), above[i]);
      }
    }
  });
  for (OpenLinks& loose : level.loose) {
    size_t t = 0;
    for (const OpenLinks::Cell& at : loose.cells) {
      for (; t < static_cast<size_t>(at.end); ++t) {
        OpenLink& link = loose.links[t];
        if (link.conductance == 0.0f) continue;
        link.conductance = link.weight * limited(at.cell, link.other, link.closeness,
                                                 link.conductance / link.weight);
      }
    }
  }
}

/// What prolong_from() is to leave of the differences within a block.
float Smoother::kept_of_block(size_t number, int32_t block) const {
  const Level& level = levels_[number];
  const SmoothingLevel& grid = grid_.levels[number];
  const float closeness = from_half(std::max(grid.to_right()[block], grid.upwards()[block]));
  const float least = 0.5f * least_variance_ * closeness;
  const float by_depth = 0.5f * third_squared(level.at(level.before)[block]) * closeness;
  const float most = bank_limit(cells_to_foot(number, block));
  const bool in_bank = level.bank.distance.data()[level.margin + block] != 0;
  return kept_part(std::max(least, in_bank ? std::min(by_depth, most) : by_depth),
                   done_below_[number]);
}

/// The heights that prolong_from() is to leave in blocks of a bank, as it finds them: the loops
/// over runs do not know banks.
std::vector<Smoother::NewHeight> Smoother::prolonged_bank(size_t number) const {
  const Level& level = levels_[number];
  const Level& fine = levels_[number - 1];
  const SmoothingLevel& fine_grid = grid_.levels[number - 1];
  const float* const height = fine.at(fine.height);
  const auto joined = [&](int32_t cell) {
    return fine_grid.joins[cell] != 0 ? height[cell] : 0.0f;
  };
  std::vector<NewHeight> heights;
  for (const int32_t block : level.bank.cells) {
    const float before = level.at(level.before)[block];
    if (before == 0.0f) continue;
    const float now = level.at(level.height)[block];
    const float kept = kept_of_block(number, block);
    const auto cells = cells_of_block(block, grid_.levels[number].size, fine_grid.size);
    float most = 0.0f;
    for (const int32_t cell : cells) {
      if (std::fabs(most) < std::fabs(joined(cell))) most = joined(cell);
    }
    for (const int32_t cell : cells) {
      if (!is_open(joined(cell), most)) continue;
      heights.push_back({cell, changed(height[cell], before, now, kept)});
    }
  }
  return heights;
}

/// Leaves no bank for the next map.
void Smoother::clear_banks() {
  for (Level& level : levels_) {
    for (const int32_t cell : level.bank.cells) {
      level.bank.distance.data()[level.margin + cell] = 0;
    }
    level.bank.cells.clear();
  }
}

}  // namespace snowbough::snow
