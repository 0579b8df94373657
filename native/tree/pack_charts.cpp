#include "tree/pack_charts.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

namespace snowbough::tree {
namespace {

constexpr int kMaxGutter = 2;

/// Cells or heights from `begin` up to, not including, `end`.
struct Run {
  int begin = 0;
  int end = 0;
};

/// The cells where a chart may lie: of every column of the grid the free runs, from the lowest on.
class FreeCells {
 public:
  explicit FreeCells(int grid)
      : grid_(grid),
        leaves_(static_cast<int>(std::bit_ceil(static_cast<unsigned>(grid)))),
        runs_(grid),
        longest_(2 * static_cast<size_t>(leaves_), 0) {
    for (int x = 1; x + 1 < grid; ++x) {
      runs_[x].push_back({1, grid - 1});
    }
    update(0, grid);
  }

  const std::vector<Run>& column(int x) const { return runs_[x]; }
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

  /// Takes cells [begin, end) of a column; update must follow.
  void take(int x, int begin, int end) {
    if (x < 0 || x >= grid_ || begin >= end) {
      return;
    }
    std::vector<Run>& runs = runs_[x];
    const auto first =
        std::find_if(runs.begin(), runs.end(), [begin](const Run& run) { return run.end > begin; });
    const auto last =
        std::find_if(first, runs.end(), [end](const Run& run) { return run.begin >= end; });
    if (first == last) {
      return;
    }
    const Run below{first->begin, begin};
    const Run above{end, (last - 1)->end};
    auto at = runs.erase(first, last);
    if (above.begin < above.end) {
      at = runs.insert(at, above);
    }
    if (below.begin < below.end) {
      runs.insert(at, below);
    }
  }

  /// Renews what is known of the columns [from, to) after some of their cells were taken.
  void update(int from, int to) {
    from = std::max(from, 0);
    to = std::min(to, grid_);
    for (int x = from; x < to; ++x) {
      int longest = 0;
      for (const Run& run : runs_[x]) {
        longest = std::max(longest, run.end - run.begin);
      }
      longest_[leaves_ + x] = longest;
    }
    int low = (leaves_ + from) / 2;
    int high = (leaves_ + to - 1) / 2;
    for (; low > 0; low /= 2, high /= 2) {
      for (int node = low; node <= high; ++node) {
        longest_[node] = std::max(longest_[2 * node], longest_[2 * node + 1]);
      }
    }
  }

 private:
  int grid_;
  int leaves_;
  std::vector<std::vector<Run>> runs_;
  /// Longest free run of every column, and in a tree above them the longest of each subtree: node i
  /// has children 2 i and 2 i + 1, column x is node leaves_ + x.
  std::vector<int> longest_;
};

/// A shape in one of its orientations.
struct Oriented {
  Placement placement;
  std::vector<int> begin;
  std::vector<int> end;
  /// Its columns, the longest first: where it fails soonest.
  std::vector<int> columns;

  int length(int column) const { return end[column] - begin[column]; }
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
  for (Oriented& shape_so : result) {
    shape_so.columns.resize(shape.width);
    std::iota(shape_so.columns.begin(), shape_so.columns.end(), 0);
    std::sort(shape_so.columns.begin(), shape_so.columns.end(), [&shape_so](int a, int b) {
      const int long_a = shape_so.length(a), long_b = shape_so.length(b);
      return long_a != long_b ? long_a > long_b : a < b;
    });
  }
  return result;
}

/// First place from `x` on where every column of the shape has a free run long enough: all other
/// places are passed over without a look. Past the grid's end if there is none.
int next_place(const FreeCells& free, const Oriented& shape, int x, int last_x) {
  for (size_t i = 0; i < shape.columns.size() && x <= last_x; ++i) {
    const int j = shape.columns[i];
    const int next = free.next_column(x + j, shape.length(j)) - j;
    if (next != x) {
      x = next;
      i = static_cast<size_t>(-1);
    }
  }
  return x;
}

/// Finds the heights at which a shape fits.
class HeightSearch {
 public:
  /// Lowest height at which the shape fits with its left column at x; -1 if there is none.
  int lowest(const FreeCells& free, const Oriented& shape, int x) {
    heights_.assign(1, {0, std::numeric_limits<int>::max()});
    for (const int j : shape.columns) {
      // A column that nothing was marked in still stands on a free cell.
      const int length = std::max(shape.length(j), 1);
      kept_.clear();
      auto height = heights_.begin();
      for (const Run& run : free.column(x + j)) {
        const Run here{run.begin - shape.begin[j], run.end - shape.begin[j] - length + 1};
        if (here.begin >= here.end) {
          continue;
        }
        while (height != heights_.end() && height->end <= here.begin) {
          ++height;
        }
        for (auto next = height; next != heights_.end() && next->begin < here.end; ++next) {
          kept_.push_back({std::max(next->begin, here.begin), std::min(next->end, here.end)});
        }
      }
      std::swap(heights_, kept_);
      if (heights_.empty()) {
        return -1;
      }
    }
    return heights_.front().begin;
  }

 private:
  /// Runs of heights that are left, ascending.
  std::vector<Run> heights_;
  std::vector<Run> kept_;
};

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
  free.update(shape.placement.x - gutter, shape.placement.x + width + gutter);
}

}  // namespace

std::optional<std::vector<Placement>> pack_charts(const std::vector<PackShape>& shapes, int grid) {
  // A chart that keeps g cells free must lie clear of every other chart by the larger of both
  // gutters: thin charts look at what is taken with everyone's own gutter, wide ones at what is
  // taken with the widest.
  FreeCells clear_of_own(grid);
  FreeCells clear_of_widest(grid);
  HeightSearch heights;
  // What did not fit left of some column never will, as room only dwindles: the next chart of the
  // same outline starts its search there.
  std::map<std::tuple<int, std::vector<int>, std::vector<int>>, int, std::less<>> first_columns;
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
      auto first = first_columns.find(std::tie(shape.gutter, candidate.begin, candidate.end));
      if (first == first_columns.end()) {
        first = first_columns.try_emplace({shape.gutter, candidate.begin, candidate.end}, 1).first;
      }
      int x = next_place(free, candidate, first->second, last_x);
      for (; x <= last_x; x = next_place(free, candidate, x + 1, last_x)) {
        const int y = heights.lowest(free, candidate, x);
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
      first->second = std::min(x, last_x);
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
