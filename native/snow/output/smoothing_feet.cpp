// Smoother's slope feet: where snow ends in a steep slope on continuing ground, it is smoothed less
// the closer it is to the foot.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "snow/output/smoothing.h"
#include "snow/output/smoothing_kernels.h"

namespace snowbough::snow {
namespace {

/// Distance in eighths of a cell to an adjacent cell, and to a diagonal one.
constexpr int32_t kStep = kProximitySteps;
constexpr int32_t kDiagonal = 11;
constexpr uint8_t kRidgeBit = 128;
constexpr uint8_t kProximityBits = 127;
static_assert(kAtFoot <= kProximityBits);

/// The eight cells around one on the grid: right, above and below it, left, above and below it,
/// above, below. They are processed as eight bytes of a word: none exceeds 127, so the top bit of
/// each is free for the result of a comparison.
constexpr int32_t kAround = 8;
constexpr uint64_t kEachByte = 0x0101010101010101;
constexpr uint64_t kEachTop = kEachByte << 7;
constexpr uint64_t kSteps = 0x08080b0b080b0b08;
/// Bytes of the diagonal cells.
constexpr uint64_t kDiagonals = 0x0000ffff00ffff00;

/// Top bits of the cells that are not diagonal.
constexpr uint64_t kStraight = kEachTop & ~kDiagonals;

constexpr std::array<int32_t, kAround> offsets_around(int32_t size) {
  return {1, 1 + size, 1 - size, -1, size - 1, -1 - size, size, -size};
}

/// Sets the top bit of each byte of `a` that is at least that of `b`.
constexpr uint64_t at_least(uint64_t a, uint64_t b) {
  return ((a | kEachTop) - b) & kEachTop;
}

uint64_t word_around(const uint8_t* proximity, const std::array<int32_t, kAround>& offsets) {
  uint64_t word = 0;
  for (int32_t k = 0; k < kAround; ++k) {
    word |= static_cast<uint64_t>(proximity[offsets[static_cast<size_t>(k)]]) << (8 * k);
  }
  return word;
}

/// Calls visit(k) for the bytes with the top bit set.
template <typename Visit>
void for_each_byte(uint64_t tops, const Visit& visit) {
  for (; tops != 0; tops &= tops - 1) visit(static_cast<size_t>(std::countr_zero(tops) / 8));
}

/// The cells around one that are linked by snow, as top bits of their bytes. A diagonal link goes
/// through the cell beside it.
uint64_t links_around(const SmoothingLevel& grid, int32_t i) {
  const uint16_t* const right = grid.to_right() + i;
  const uint16_t* const above = grid.upwards() + i;
  const int32_t size = grid.size;
  const auto bit = [](uint16_t link, int32_t byte) {
    return uint64_t{link != 0} << (8 * byte + 7);
  };
  uint64_t links = bit(above[0], 6) | bit(above[-size], 7);
  if (right[0] != 0) links |= bit(1, 0) | bit(above[1], 1) | bit(above[1 - size], 2);
  if (right[-1] != 0) links |= bit(1, 3) | bit(above[-1], 4) | bit(above[-1 - size], 5);
  return links;
}

}  // namespace

/// Finds the cells of level 0 at the foot of a slope, and those near them.
void Smoother::find_feet() {
  Level& level = levels_[0];
  const SmoothingLevel& grid = grid_.levels[0];
  const float* const height = level.at(level.height);
  const ClosenessView closeness{grid.to_right(), grid.upwards(), grid.size};
  // Rise of the snow per cell towards one side, if it ends on the other.
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
    if (std::fabs(height[i]) * std::sqrt(closest_link(closeness, i)) > kHighestFoot) return false;
    const float along = rise(i, 1, closeness.right);
    const float across = rise(i, closeness.size, closeness.above);
    return along * along + across * across > kLeastFootSlope * kLeastFootSlope;
  };
  uint8_t* const proximity = level.feet.proximity.data() + level.margin;
  const auto note_foot = [&](int32_t i) {
    if (proximity[i] != 0 || !is_foot(i)) return;
    proximity[i] = kAtFoot - kStep / 2;
    level.feet.cells.push_back(i);
  };
  for (const std::vector<int32_t>& cells : level.edge_cells) {
    for (const int32_t cell : cells) note_foot(cell);
  }
  for (const int32_t cell : grid_.open_ends) note_foot(cell);
  spread_feet(0);
}

/// Calls visit(other) for the cells linked across seams.
template <typename Visit>
void Smoother::for_each_across(size_t number, int32_t i, const Visit& visit) const {
  const SmoothingLevel& grid = grid_.levels[number];
  if (!grid.is_linked(i)) return;
  // On level 0 links across seams replace those on the grid.
  if (number == 0 && (~links_around(grid, i) & kStraight) == 0) return;
  grid.for_each_link(i, visit);
}

/// Propagates the proximity from a level's feet, and removes ridges.
void Smoother::spread_feet(size_t number) {
  Level& level = levels_[number];
  if (level.feet.cells.empty()) return;
  for (std::vector<int32_t>& cells : level.feet.at_distance) cells.clear();
  uint8_t* const proximity = level.feet.proximity.data() + level.margin;
  for (const int32_t cell : level.feet.cells) note_proximity(level.feet, cell, proximity[cell]);
  remove_ridges(number, propagate_proximity(number));
}

void Smoother::note_proximity(SlopeFeet& feet, int32_t cell, int32_t proximity) {
  feet.at_distance[static_cast<size_t>(kAtFoot - proximity)].push_back(cell);
}

/// Returns the cells that are farther from their feet than all their neighbours.
///
/// E. W. Dijkstra, A Note on Two Problems in Connexion with Graphs, 1959, with one list per
/// distance: R. B. Dial, Algorithm 360, 1969.
std::vector<int32_t> Smoother::propagate_proximity(size_t number) {
  Level& level = levels_[number];
  const float* const height = level.at(level.height);
  const SmoothingLevel& grid = grid_.levels[number];
  const std::array<int32_t, kAround> offsets = offsets_around(grid.size);
  uint8_t* const proximity = level.feet.proximity.data() + level.margin;
  std::vector<int32_t> crests;
  for (int32_t from = kAtFoot; from > 0; --from) {
    // The last distances reach no further cell, and some before them no diagonal one.
    const uint64_t within = from > kDiagonal ? kEachTop : from > kStep ? kStraight : 0;
    const uint64_t steps = kSteps & within / (kProximityBits + 1) * kProximityBits;
    const uint64_t to = static_cast<uint64_t>(from) * kEachByte - steps;
    std::vector<int32_t>& cells = level.feet.at_distance[static_cast<size_t>(kAtFoot - from)];
    for (size_t c = 0; c < cells.size(); ++c) {
      const int32_t i = cells[c];
      if (proximity[i] != from) continue;  // reached on a shorter way since
      bool is_crest = true;
      const auto visit = [&](int32_t j, int32_t there, bool is_reached) {
        if (height[i] * height[j] <= 0.0f) return;
        is_crest = false;
        if (!is_reached) return;
        if (proximity[j] == 0) level.feet.cells.push_back(j);
        proximity[j] = static_cast<uint8_t>(there);
        note_proximity(level.feet, j, there);
      };
      const uint64_t around = word_around(proximity + i, offsets);
      const uint64_t farther = at_least(static_cast<uint64_t>(from - 1) * kEachByte, around);
      if (farther != 0) {
        const uint64_t nearer = at_least(to, around + kEachByte) & within;
        const uint64_t links = farther & links_around(grid, i);
        for_each_byte(links & nearer, [&](size_t k) {
          visit(i + offsets[k], static_cast<int32_t>(to >> (8 * k) & kProximityBits), true);
        });
        for (uint64_t left = is_crest ? links & ~nearer : 0; left != 0 && is_crest;
             left &= left - 1) {
          visit(i + offsets[static_cast<size_t>(std::countr_zero(left) / 8)], 0, false);
        }
      }
      for_each_across(number, i, [&](int32_t j) {
        if (proximity[j] < from)
          visit(j, from - kStep, from > kStep && proximity[j] < from - kStep);
      });
      if (is_crest) crests.push_back(i);
    }
  }
  return crests;
}

/// On a ridge all snow is near a foot: its crest is farthest from the feet and still steeply above
/// them. Ridges are smoothed normally, otherwise posts and twigs would carry tent-like caps.
void Smoother::remove_ridges(size_t number, const std::vector<int32_t>& crests) {
  Level& level = levels_[number];
  const float* const height = level.at(level.height);
  const SmoothingLevel& grid = grid_.levels[number];
  const ClosenessView closeness{grid.to_right(), grid.upwards(), grid.size};
  const std::array<int32_t, kAround> offsets = offsets_around(grid.size);
  uint8_t* const proximity = level.feet.proximity.data() + level.margin;
  // The neighbour farthest from the foot decides whether a cell is on a ridge.
  const auto is_on_ridge = [&](int32_t i, int32_t own) {
    int32_t farthest = own;
    bool is_ridge = false;
    const auto look = [&](int32_t j) {
      const int32_t there = proximity[j] & kProximityBits;
      if (there >= farthest || height[i] * height[j] <= 0.0f) return;
      farthest = there;
      is_ridge = (proximity[j] & kRidgeBit) != 0;
    };
    for_each_byte(links_around(grid, i), [&](size_t k) { look(i + offsets[k]); });
    for_each_across(number, i, look);
    return is_ridge;
  };
  for (std::vector<int32_t>& cells : level.feet.at_distance) cells.clear();
  std::vector<int32_t> ridge;
  const auto note_ridge = [&](int32_t i, int32_t own) {
    proximity[i] |= kRidgeBit;
    ridge.push_back(i);
    // Asks in both directions, since diagonal links may be one-way.
    const auto ask = [&](int32_t j) {
      const int32_t there = proximity[j] & kProximityBits;
      if (there > own) note_proximity(level.feet, j, there);
    };
    for (const int32_t offset : offsets) ask(i + offset);
    grid.for_each_link(i, ask);
  };
  for (const int32_t i : crests) {
    const float cells_high = std::fabs(height[i]) * std::sqrt(closest_link(closeness, i));
    const int32_t own = proximity[i];
    if (cells_high * kProximitySteps > kLeastFootSlope * static_cast<float>(kAtFoot - own)) {
      note_ridge(i, own);
    }
  }
  for (int32_t own = 1; own <= kAtFoot; ++own) {
    for (const int32_t i : level.feet.at_distance[static_cast<size_t>(kAtFoot - own)]) {
      if (proximity[i] == own && is_on_ridge(i, own)) note_ridge(i, own);
    }
  }
  if (ridge.empty()) return;
  for (const int32_t cell : ridge) proximity[cell] = 0;
  std::erase_if(level.feet.cells, [&](int32_t cell) { return proximity[cell] == 0; });
}

/// Fills a level's proximity from the finer level: a block is half as many cells away as its
/// nearest cell.
void Smoother::restrict_feet(size_t number) {
  const Level& fine = levels_[number - 1];
  Level& level = levels_[number];
  const SmoothingLevel& fine_grid = grid_.levels[number - 1];
  const int32_t size = grid_.levels[number].size;
  const uint8_t* const from = fine.feet.proximity.data() + fine.margin;
  uint8_t* const to = level.feet.proximity.data() + level.margin;
  for (const int32_t cell : fine.feet.cells) {
    if (fine_grid.joins[cell] == 0) continue;
    const int32_t block = cell / fine_grid.size / 2 * size + cell % fine_grid.size / 2;
    const int32_t distance = (kAtFoot - from[cell]) / 2 + kProximitySteps / 4;
    if (to[block] == 0) level.feet.cells.push_back(block);
    to[block] = std::max(to[block], static_cast<uint8_t>(kAtFoot - distance));
  }
  spread_feet(number);
}

/// Limits the conductances of a run near feet.
void Smoother::limit_run(size_t number, Run run, const ConductanceTerms& terms) {
  Level& level = levels_[number];
  if (level.feet.cells.empty()) return;
  constexpr int32_t kTogether = 64;
  const SmoothingLevel& grid = grid_.levels[number];
  const uint8_t* const proximity = level.feet.proximity.data() + level.margin;
  for (int32_t i = run.begin; i < run.end; i += kTogether) {
    const int32_t end = std::min(i + kTogether, run.end);
    if (!any_near_foot(proximity + i, end - i + 1) &&
        !any_near_foot(proximity + i + grid.size, end - i))
      continue;
    limit_feet_run(proximity, level.at(level.inverse_weight),
                   {grid.to_right(), grid.upwards(), grid.size}, level.at(level.right),
                   level.at(level.above), terms, i, end);
  }
}

/// Damping factor of the differences within a block, for prolong_from().
float Smoother::damping_of_block(size_t number, int32_t block) const {
  const Level& level = levels_[number];
  const SmoothingLevel& grid = grid_.levels[number];
  const float closeness = from_half(std::max(grid.to_right()[block], grid.upwards()[block]));
  return damping(level.at(level.before)[block], closeness,
                 level.feet.proximity.data()[level.margin + block], least_variance_,
                 done_below_[number]);
}

/// Clears the proximity for the next map.
void Smoother::clear_feet() {
  for (Level& level : levels_) {
    for (const int32_t cell : level.feet.cells) {
      level.feet.proximity.data()[level.margin + cell] = 0;
    }
    level.feet.cells.clear();
  }
}

}  // namespace snowbough::snow
