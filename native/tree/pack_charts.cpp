#include "tree/pack_charts.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

namespace snowbough::tree {
namespace {

constexpr int kWordBits = 64;
constexpr int kMaxGutter = 2;

/// A set of heights, one bit each.
using Words = std::vector<uint64_t>;

/// keep(y) &= source(y + distance); beyond the end there is nothing free. Works upwards, so that
/// both may be the same.
void and_shifted(uint64_t* keep, const uint64_t* source, int count, int distance) {
  const int whole = distance / kWordBits;
  const int part = distance % kWordBits;
  const int last = count - whole - 1;
  if (part == 0) {
    for (int i = 0; i <= last; ++i) {
      keep[i] &= source[i + whole];
    }
  } else {
    for (int i = 0; i < last; ++i) {
      keep[i] &= (source[i + whole] >> part) | (source[i + whole + 1] << (kWordBits - part));
    }
    if (last >= 0) {
      keep[last] &= source[count - 1] >> part;
    }
  }
  std::fill(keep + std::max(last + 1, 0), keep + count, 0);
}

/// One bit a cell of the grid: set where a chart may lie. Column by column.
class FreeCells {
 public:
  explicit FreeCells(int grid)
      : grid_(grid),
        words_((grid + kWordBits - 1) / kWordBits),
        leaves_(static_cast<int>(std::bit_ceil(static_cast<unsigned>(grid)))),
        bits_(static_cast<size_t>(grid) * words_, 0),
        longest_(2 * static_cast<size_t>(leaves_), 0) {
    Words inner(words_, ~uint64_t{0});
    inner.front() &= ~uint64_t{1};
    for (int y = grid - 1; y < words_ * kWordBits; ++y) {
      inner[y / kWordBits] &= ~(uint64_t{1} << (y % kWordBits));
    }
    for (int x = 1; x + 1 < grid; ++x) {
      std::copy(inner.begin(), inner.end(), &bits_[static_cast<size_t>(x) * words_]);
      longest_[leaves_ + x] = grid - 2;
    }
    for (int node = leaves_ - 1; node > 0; --node) {
      longest_[node] = std::max(longest_[2 * node], longest_[2 * node + 1]);
    }
  }

  int words() const { return words_; }
  const uint64_t* column(int x) const { return &bits_[static_cast<size_t>(x) * words_]; }
  int longest_run(int x) const { return longest_[leaves_ + x]; }

  /// First column from `x` on with a free run of `length` cells; the grid's width if there is none.
  int next_column(int x, int length) const {
    int node = leaves_ + x;
    while (longest_[node] < length) {
      // Past the end of every subtree that ends here, then to the one right of it.
      while (node % 2 == 1) {
        node /= 2;
      }
      if (node == 0) {
        return grid_;
      }
      ++node;
    }
    while (node < leaves_) {
      node = longest_[2 * node] >= length ? 2 * node : 2 * node + 1;
    }
    return node - leaves_;
  }

  /// Takes cells [begin, end) of a column.
  void take(int x, int begin, int end) {
    if (x < 0 || x >= grid_) {
      return;
    }
    begin = std::max(begin, 0);
    end = std::min(end, grid_);
    uint64_t* column = &bits_[static_cast<size_t>(x) * words_];
    for (int word = begin / kWordBits; word * kWordBits < end; ++word) {
      const int low = std::max(begin - word * kWordBits, 0);
      const int high = std::min(end - word * kWordBits, kWordBits);
      const uint64_t mask =
          high - low == kWordBits ? ~uint64_t{0} : ((uint64_t{1} << (high - low)) - 1) << low;
      column[word] &= ~mask;
    }
    int node = leaves_ + x;
    longest_[node] = find_longest_run(x);
    for (node /= 2; node > 0; node /= 2) {
      longest_[node] = std::max(longest_[2 * node], longest_[2 * node + 1]);
    }
  }

 private:
  int find_longest_run(int x) const {
    const uint64_t* column = this->column(x);
    int best = 0;
    int run = 0;
    for (int i = 0; i < words_; ++i) {
      uint64_t word = column[i];
      if (word == 0 || word == ~uint64_t{0}) {
        run = word == 0 ? 0 : run + kWordBits;
        best = std::max(best, run);
        continue;
      }
      int left = kWordBits;
      while (left > 0) {
        const int ones = std::min(std::countr_one(word), left);
        run += ones;
        best = std::max(best, run);
        left -= ones;
        if (left == 0) {
          break;
        }
        run = 0;
        word >>= ones;
        const int zeros = std::min(std::countr_zero(word), left);
        left -= zeros;
        word = zeros == kWordBits ? 0 : word >> zeros;
      }
    }
    return best;
  }

  int grid_;
  int words_;
  int leaves_;
  std::vector<uint64_t> bits_;
  /// Longest free run of every column, and in a tree above them the longest of each subtree: node i
  /// has children 2 i and 2 i + 1, column x is node leaves_ + x.
  std::vector<int> longest_;
};

/// Columns that are taken over the same heights.
struct ColumnGroup {
  int begin = 0;
  int end = 0;
  std::vector<int> columns;

  int length() const { return end - begin; }
};

/// A shape in one of its orientations; its longest columns first, where it fails soonest.
struct Oriented {
  Placement placement;
  std::vector<int> begin;
  std::vector<int> end;
  std::vector<ColumnGroup> groups;
};

Oriented orient(const PackShape& shape, bool columns_reversed, bool rows_reversed) {
  Oriented result;
  result.placement = {0, 0, columns_reversed, rows_reversed};
  result.begin = shape.begin;
  result.end = shape.end;
  if (rows_reversed) {
    for (int j = 0; j < shape.width; ++j) {
      result.begin[j] = shape.height - shape.end[j];
      result.end[j] = shape.height - shape.begin[j];
    }
  }
  if (columns_reversed) {
    std::reverse(result.begin.begin(), result.begin.end());
    std::reverse(result.end.begin(), result.end.end());
  }
  for (int j = 0; j < shape.width; ++j) {
    const bool same =
        j > 0 && result.begin[j] == result.begin[j - 1] && result.end[j] == result.end[j - 1];
    if (!same) {
      result.groups.push_back({result.begin[j], result.end[j], {}});
    }
    result.groups.back().columns.push_back(j);
  }
  std::stable_sort(
      result.groups.begin(), result.groups.end(),
      [](const ColumnGroup& a, const ColumnGroup& b) { return a.length() > b.length(); });
  return result;
}

std::vector<Oriented> orientations(const PackShape& shape) {
  std::vector<Oriented> result;
  for (const bool rows_reversed : {false, true}) {
    for (const bool columns_reversed : {false, true}) {
      Oriented next = orient(shape, columns_reversed, rows_reversed);
      const bool known = std::any_of(result.begin(), result.end(), [&next](const Oriented& other) {
        return other.begin == next.begin && other.end == next.end;
      });
      if (!known) {
        result.push_back(std::move(next));
      }
    }
  }
  return result;
}

/// Whether any column has no free run long enough for the shape; cheap, and mostly so.
bool is_hopeless(const FreeCells& free, const Oriented& shape, int x) {
  for (const ColumnGroup& group : shape.groups) {
    for (const int j : group.columns) {
      if (free.longest_run(x + j) < group.length()) {
        return true;
      }
    }
  }
  return false;
}

/// Lowest height at which the shape fits with its left column at x; -1 if there is none.
int lowest_fit(const FreeCells& free, const Oriented& shape, int x, Words& feasible, Words& run) {
  const int words = free.words();
  feasible.assign(words, ~uint64_t{0});
  run.resize(words);
  for (const ColumnGroup& group : shape.groups) {
    const uint64_t* first = free.column(x + group.columns.front());
    std::copy(first, first + words, run.begin());
    for (size_t i = 1; i < group.columns.size(); ++i) {
      and_shifted(run.data(), free.column(x + group.columns[i]), words, 0);
    }
    // Heights from which a run of `covered` cells is free; doubled until it is the group's length.
    int covered = 1;
    while (covered < group.length()) {
      const int step = std::min(covered, group.length() - covered);
      and_shifted(run.data(), run.data(), words, step);
      covered += step;
    }
    and_shifted(feasible.data(), run.data(), words, group.begin);
    if (std::all_of(feasible.begin(), feasible.end(), [](uint64_t word) { return word == 0; })) {
      return -1;
    }
  }
  for (int i = 0; i < words; ++i) {
    if (feasible[i] != 0) {
      return i * kWordBits + std::countr_zero(feasible[i]);
    }
  }
  return -1;
}

void take_with_gutter(FreeCells& free, const Oriented& shape, int gutter) {
  const auto width = static_cast<int>(shape.begin.size());
  for (int j = -gutter; j < width + gutter; ++j) {
    int begin = std::numeric_limits<int>::max();
    int end = std::numeric_limits<int>::min();
    for (int k = std::max(j - gutter, 0); k <= std::min(j + gutter, width - 1); ++k) {
      begin = std::min(begin, shape.begin[k]);
      end = std::max(end, shape.end[k]);
    }
    free.take(shape.placement.x + j, shape.placement.y + begin - gutter,
              shape.placement.y + end + gutter);
  }
}

}  // namespace

std::optional<std::vector<Placement>> pack_charts(const std::vector<PackShape>& shapes, int grid) {
  // A chart that keeps g cells free must lie clear of every other chart by the larger of both
  // gutters: thin charts look at what is taken with everyone's own gutter, wide ones at what is
  // taken with the widest.
  FreeCells clear_of_own(grid);
  FreeCells clear_of_widest(grid);
  Words feasible;
  Words run;
  // What did not fit left of some column never will, as room only dwindles: the next chart of the
  // same outline starts its search there.
  std::map<std::tuple<int, std::vector<int>, std::vector<int>>, int> first_columns;
  std::vector<Placement> placements(shapes.size());
  for (size_t i = 0; i < shapes.size(); ++i) {
    const PackShape& shape = shapes[i];
    if (shape.width > grid - 2) {
      return std::nullopt;
    }
    const FreeCells& free = shape.gutter < kMaxGutter ? clear_of_own : clear_of_widest;
    std::vector<Oriented> candidates = orientations(shape);
    const Oriented* found = nullptr;
    int last_x = grid - 1 - shape.width;
    for (Oriented& candidate : candidates) {
      const ColumnGroup& longest = candidate.groups.front();
      const int offset = longest.columns.front();
      int& first_x = first_columns.try_emplace({shape.gutter, candidate.begin, candidate.end}, 1)
                         .first->second;
      int x = free.next_column(first_x + offset, longest.length()) - offset;
      for (; x <= last_x; x = free.next_column(x + 1 + offset, longest.length()) - offset) {
        const int y =
            is_hopeless(free, candidate, x) ? -1 : lowest_fit(free, candidate, x, feasible, run);
        if (y < 0) {
          continue;
        }
        if (found == nullptr || x < last_x || y < found->placement.y) {
          candidate.placement.x = x;
          candidate.placement.y = y;
          found = &candidate;
        }
        last_x = x;
        break;
      }
      first_x = std::min(x, last_x);
    }
    if (found == nullptr) {
      return std::nullopt;
    }
    placements[i] = found->placement;
    take_with_gutter(clear_of_own, *found, shape.gutter);
    take_with_gutter(clear_of_widest, *found, kMaxGutter);
  }
  return placements;
}

}  // namespace snowbough::tree
