#include "tree/pack_charts.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

namespace snowbough::tree {
namespace {

constexpr int kWordBits = 64;
constexpr int kMaxGutter = 2;

/// A set of heights, one bit each.
using Words = std::vector<uint64_t>;

/// keep(y) &= source(y + distance); beyond the end there is nothing free.
void and_shifted(Words& keep, const uint64_t* source, int distance) {
  const int count = static_cast<int>(keep.size());
  const int whole = distance / kWordBits;
  const int part = distance % kWordBits;
  for (int i = 0; i < count; ++i) {
    const uint64_t low = i + whole < count ? source[i + whole] : 0;
    const uint64_t high = i + whole + 1 < count ? source[i + whole + 1] : 0;
    keep[i] &= part == 0 ? low : (low >> part) | (high << (kWordBits - part));
  }
}

/// One bit a cell of the grid: set where a chart may lie. Column by column.
class FreeCells {
 public:
  explicit FreeCells(int grid)
      : words_((grid + kWordBits - 1) / kWordBits),
        bits_(static_cast<size_t>(grid) * words_, 0),
        longest_(grid, grid) {
    for (int x = 1; x + 1 < grid; ++x) {
      for (int y = 1; y + 1 < grid; ++y) {
        bits_[static_cast<size_t>(x) * words_ + y / kWordBits] |= uint64_t{1} << (y % kWordBits);
      }
      longest_[x] = -1;
    }
    longest_.front() = longest_.back() = 0;
  }

  int words() const { return words_; }
  const uint64_t* column(int x) const { return &bits_[static_cast<size_t>(x) * words_]; }

  /// Takes cells [begin, end) of a column.
  void take(int x, int begin, int end) {
    const int grid = static_cast<int>(longest_.size());
    if (x < 0 || x >= grid) {
      return;
    }
    begin = std::max(begin, 0);
    end = std::min(end, grid);
    uint64_t* column = &bits_[static_cast<size_t>(x) * words_];
    for (int word = begin / kWordBits; word * kWordBits < end; ++word) {
      const int low = std::max(begin - word * kWordBits, 0);
      const int high = std::min(end - word * kWordBits, kWordBits);
      const uint64_t mask =
          high - low == kWordBits ? ~uint64_t{0} : ((uint64_t{1} << (high - low)) - 1) << low;
      column[word] &= ~mask;
    }
    longest_[x] = -1;
  }

  /// Length of the longest free run of a column; kept until the column changes.
  int longest_run(int x) {
    if (longest_[x] >= 0) {
      return longest_[x];
    }
    const uint64_t* column = this->column(x);
    int best = 0;
    int run = 0;
    for (int i = 0; i < words_; ++i) {
      uint64_t word = column[i];
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
        word = ones == kWordBits ? 0 : word >> ones;
        const int zeros = std::min(std::countr_zero(word), left);
        left -= zeros;
        word = zeros == kWordBits ? 0 : word >> zeros;
      }
    }
    return longest_[x] = best;
  }

 private:
  int words_;
  std::vector<uint64_t> bits_;
  std::vector<int> longest_;
};

/// A shape in one of its orientations, with its columns in the order in which they fail soonest.
struct Oriented {
  Placement placement;
  std::vector<int> begin;
  std::vector<int> end;
  std::vector<int> order;
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
  result.order.resize(shape.width);
  std::iota(result.order.begin(), result.order.end(), 0);
  std::stable_sort(result.order.begin(), result.order.end(), [&](int a, int b) {
    return result.end[a] - result.begin[a] > result.end[b] - result.begin[b];
  });
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

/// Scratch space of the search for heights.
struct Search {
  Words feasible;
  Words run;
  Words doubled;
};

/// Lowest height at which the shape fits with its left column at x; -1 if there is none.
int lowest_fit(FreeCells& free, const Oriented& shape, int x, Search& search) {
  for (const int j : shape.order) {
    if (free.longest_run(x + j) < shape.end[j] - shape.begin[j]) {
      return -1;
    }
  }
  search.feasible.assign(free.words(), ~uint64_t{0});
  for (const int j : shape.order) {
    const int length = shape.end[j] - shape.begin[j];
    const uint64_t* column = free.column(x + j);
    search.run.assign(column, column + free.words());
    int covered = 1;
    while (covered < length) {
      const int step = std::min(covered, length - covered);
      search.doubled = search.run;
      and_shifted(search.run, search.doubled.data(), step);
      covered += step;
    }
    and_shifted(search.feasible, search.run.data(), shape.begin[j]);
    if (std::all_of(search.feasible.begin(), search.feasible.end(),
                    [](uint64_t word) { return word == 0; })) {
      return -1;
    }
  }
  for (size_t i = 0; i < search.feasible.size(); ++i) {
    if (search.feasible[i] != 0) {
      return static_cast<int>(i) * kWordBits + std::countr_zero(search.feasible[i]);
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
  Search search;
  std::vector<Placement> placements(shapes.size());
  for (size_t i = 0; i < shapes.size(); ++i) {
    const PackShape& shape = shapes[i];
    FreeCells& free = shape.gutter < kMaxGutter ? clear_of_own : clear_of_widest;
    std::vector<Oriented> candidates = orientations(shape);
    Oriented* found = nullptr;
    for (int x = 1; x + shape.width < grid && found == nullptr; ++x) {
      for (Oriented& candidate : candidates) {
        const int y = lowest_fit(free, candidate, x, search);
        if (y >= 0 && (found == nullptr || y < found->placement.y)) {
          candidate.placement.x = x;
          candidate.placement.y = y;
          found = &candidate;
        }
      }
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
