#include "tree/uv/pack_charts.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

namespace snowbough::tree {
namespace {

constexpr int kMaxGutter = 2;
/// Places along the grid that are examined together.
constexpr int kBlock = 64;
/// Columns of a chart between two checks whether any place of a block is left.
constexpr int kColumnsAtOnce = 4;

/// A number of cells: 16 bits, so that eight fit into a register.
using Cells = int16_t;

/// Free cells from `begin` up to, not including, `end`.
struct FreeRun {
  Cells begin = 0;
  Cells end = 0;
};

/// The free cells: of every column of the grid the free runs, from the lowest on.
class FreeCells {
 public:
  FreeCells(int rows, int columns)
      : columns_(columns),
        runs_(static_cast<size_t>(columns) * capacity_),
        counts_(columns, 0),
        longest_(static_cast<size_t>(columns) + kBlock, 0) {
    for (int x = 1; x + 1 < columns && rows > 2; ++x) {
      column(x)[0] = {1, static_cast<Cells>(rows - 1)};
      counts_[x] = 1;
      longest_[x] = static_cast<Cells>(rows - 2);
    }
  }

  std::span<const FreeRun> column(int x) const {
    return {runs_.data() + static_cast<size_t>(x) * capacity_, static_cast<size_t>(counts_[x])};
  }

  /// Length of the longest run of every column from x on; kBlock zeros follow the last one.
  const Cells* longest(int x) const { return longest_.data() + x; }

  /// Occupies cells [begin, end) of a column; ignores the part outside the grid.
  void take(int x, int begin, int end) {
    if (x < 0 || x >= columns_) {
      return;
    }
    FreeRun* const runs = column(x);
    const int count = counts_[x];
    int first = 0;
    while (first < count && runs[first].end <= begin) {
      ++first;
    }
    int last = first;
    while (last < count && runs[last].begin < end) {
      ++last;
    }
    if (first == last) {
      return;
    }
    std::array<FreeRun, 2> kept;
    int kept_count = 0;
    if (runs[first].begin < begin) {
      kept[kept_count++] = {runs[first].begin, static_cast<Cells>(begin)};
    }
    if (end < runs[last - 1].end) {
      kept[kept_count++] = {static_cast<Cells>(end), runs[last - 1].end};
    }
    replace(x, first, last, {kept.data(), static_cast<size_t>(kept_count)});
  }

 private:
  FreeRun* column(int x) { return runs_.data() + static_cast<size_t>(x) * capacity_; }

  /// Replaces runs [first, last) of a column by `kept`.
  void replace(int x, int first, int last, std::span<const FreeRun> kept) {
    const int count = counts_[x];
    const int change = static_cast<int>(kept.size()) - (last - first);
    if (count + change > capacity_) {
      widen();
    }
    FreeRun* const runs = column(x);
    if (change > 0) {
      std::move_backward(runs + last, runs + count, runs + count + change);
    } else if (change < 0) {
      std::move(runs + last, runs + count, runs + last + change);
    }
    std::copy(kept.begin(), kept.end(), runs + first);
    counts_[x] = count + change;
    int longest = 0;
    for (int i = 0; i < counts_[x]; ++i) {
      longest = std::max(longest, runs[i].end - runs[i].begin);
    }
    longest_[x] = static_cast<Cells>(longest);
  }

  /// Doubles the capacity for runs per column.
  void widen() {
    std::vector<FreeRun> wider(runs_.size() * 2);
    for (int x = 0; x < columns_; ++x) {
      const FreeRun* const runs = column(x);
      std::copy(runs, runs + counts_[x], wider.data() + static_cast<size_t>(x) * capacity_ * 2);
    }
    runs_ = std::move(wider);
    capacity_ *= 2;
  }

  int columns_;
  /// Capacity for runs per column.
  int capacity_ = 16;
  std::vector<FreeRun> runs_;
  std::vector<int> counts_;
  std::vector<Cells> longest_;
};

/// A shape in one of its orientations.
class Orientation {
 public:
  /// Orients the shape's columns. Reuses its vectors.
  void set(std::span<const CellRun> columns, int height, bool columns_reversed,
           bool rows_reversed) {
    columns_.assign(columns.begin(), columns.end());
    if (columns_reversed) {
      std::reverse(columns_.begin(), columns_.end());
    }
    if (rows_reversed) {
      for (CellRun& run : columns_) {
        run = {height - run.end, height - run.begin};
      }
    }
    placement = {0, 0, columns_reversed, rows_reversed};
  }

  const std::vector<CellRun>& columns() const { return columns_; }
  int width() const { return static_cast<int>(columns_.size()); }

  /// Lowest height at which the shape fits with its left column at x; -1 if there is none.
  int lowest(const FreeCells& free, int x) const {
    // Each column in turn raises the height until it fits; done once all agree. The straight edge
    // comes first, since charts are longest there.
    const int first = placement.columns_reversed ? width() - 1 : 0;
    const int step = placement.columns_reversed ? -1 : 1;
    int height = 0;
    int agreed = 0;
    for (int j = first; agreed < width(); j += step) {
      j = j < 0 || j == width() ? first : j;
      const auto [begin, end] = columns_[j];
      int fits = -1;
      for (const FreeRun& run : free.column(x + j)) {
        const int lowest = std::max<int>(run.begin, height + begin);
        if (lowest + (end - begin) <= run.end) {
          fits = lowest - begin;
          break;
        }
      }
      if (fits < 0) {
        return -1;
      }
      agreed = fits == height ? agreed + 1 : 1;
      height = fits;
    }
    return height;
  }

  Placement placement;

 private:
  std::vector<CellRun> columns_;
};

/// Of kBlock places from x on, those where a shape may fit by the longest run of every column: one
/// bit per place, the lowest for x.
uint64_t roomy_places(const FreeCells& free, const Orientation& shape, int x) {
  // The minimum over all columns of the excess of a column's longest run over the shape's need.
  std::array<Cells, kBlock> slack;
  slack.fill(std::numeric_limits<Cells>::max());
  for (int j = 0; j < shape.width(); ++j) {
    const CellRun& run = shape.columns()[j];
    const auto length = static_cast<Cells>(run.end - run.begin);
    const Cells* const longest = free.longest(x + j);
    for (int i = 0; i < kBlock; ++i) {
      slack[i] = std::min(slack[i], static_cast<Cells>(longest[i] - length));
    }
    if (j % kColumnsAtOnce == 0 || j + 1 == shape.width()) {
      Cells most = -1;
      for (int i = 0; i < kBlock; ++i) {
        most = std::max(most, slack[i]);
      }
      if (most < 0) {
        return 0;
      }
    }
  }
  std::array<uint8_t, kBlock> roomy;
  for (int i = 0; i < kBlock; ++i) {
    roomy[i] = slack[i] >= 0 ? 1 : 0;
  }
  uint64_t places = 0;
  for (int i = 0; i < kBlock; ++i) {
    places |= uint64_t{roomy[i]} << static_cast<unsigned>(i);
  }
  return places;
}

void take_with_gutter(FreeCells& free, const Orientation& shape, int gutter) {
  const int width = shape.width();
  for (int j = -gutter; j < width + gutter; ++j) {
    int begin = std::numeric_limits<int>::max();
    int end = std::numeric_limits<int>::min();
    for (int k = std::max(j - gutter, 0); k <= std::min(j + gutter, width - 1); ++k) {
      begin = std::min(begin, shape.columns()[k].begin);
      end = std::max(end, shape.columns()[k].end);
    }
    free.take(shape.placement.x + j, shape.placement.y + begin - gutter,
              shape.placement.y + end + gutter);
  }
}

/// The four orientations of a shape, without duplicates.
class Orientations {
 public:
  void set(std::span<const CellRun> columns, int height) {
    count_ = 0;
    for (const bool rows_reversed : {false, true}) {
      for (const bool columns_reversed : {false, true}) {
        Orientation& next = all_[count_];
        next.set(columns, height, columns_reversed, rows_reversed);
        const bool known =
            std::any_of(all_.begin(), all_.begin() + count_,
                        [&](const Orientation& o) { return o.columns() == next.columns(); });
        count_ += known ? 0 : 1;
      }
    }
  }

  /// Places the shape as far left as possible, from first_x on, and there as far down as possible.
  /// @return its orientation; null if it does not fit.
  const Orientation* place(const FreeCells& free, int first_x, int last_x) {
    for (int block = first_x; block <= last_x; block += kBlock) {
      std::array<uint64_t, 4> room{};
      uint64_t places = 0;
      for (int i = 0; i < count_; ++i) {
        // Reversing rows keeps the lengths of the columns.
        const bool known =
            i >= 2 && all_[i].placement.columns_reversed == all_[i - 2].placement.columns_reversed;
        room[i] = known ? room[i - 2] : roomy_places(free, all_[i], block);
        places |= room[i];
      }
      for (; places != 0; places &= places - 1) {
        const int place = std::countr_zero(places);
        if (block + place > last_x) {
          break;
        }
        if (const Orientation* found = lay(free, room, place, block + place)) {
          return found;
        }
      }
    }
    return nullptr;
  }

 private:
  /// Places the shape as far down as possible with its left column at x; null if it does not fit.
  /// @param room  the places where each orientation may fit; x is number `place` of them.
  const Orientation* lay(const FreeCells& free, const std::array<uint64_t, 4>& room, int place,
                         int x) {
    Orientation* found = nullptr;
    for (int i = 0; i < count_; ++i) {
      if ((room[i] >> static_cast<unsigned>(place) & 1U) == 0) {
        continue;
      }
      const int y = all_[i].lowest(free, x);
      if (y >= 0 && (found == nullptr || y < found->placement.y)) {
        found = &all_[i];
        found->placement.x = x;
        found->placement.y = y;
      }
    }
    return found;
  }

  std::array<Orientation, 4> all_;
  int count_ = 0;
};

/// Packing order: high charts determine the columns that lower charts fill.
std::vector<size_t> packing_order(const PackShapes& shapes) {
  std::vector<size_t> order(shapes.shapes.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    const PackShape& p = shapes.shapes[a];
    const PackShape& q = shapes.shapes[b];
    if (p.height != q.height || p.width != q.width) {
      return p.height != q.height ? p.height > q.height : p.width > q.width;
    }
    const auto before = [](const CellRun& r, const CellRun& s) {
      return r.begin != s.begin ? r.begin < s.begin : r.end < s.end;
    };
    const auto r = shapes.columns_of(p), s = shapes.columns_of(q);
    return std::lexicographical_compare(r.begin(), r.end(), s.begin(), s.end(), before);
  });
  return order;
}

bool same_outline(const PackShapes& shapes, const PackShape& a, const PackShape& b) {
  const auto r = shapes.columns_of(a), s = shapes.columns_of(b);
  return a.height == b.height && a.gutter == b.gutter &&
         std::equal(r.begin(), r.end(), s.begin(), s.end());
}

}  // namespace

std::optional<Packing> pack_charts(const PackShapes& shapes, int rows, int columns) {
  // Two charts are separated by the larger of their gutters: thin charts are tested against cells
  // occupied with each chart's own gutter, wide ones against cells occupied with the widest.
  FreeCells clear_of_own(rows, columns);
  FreeCells clear_of_widest(rows, columns);
  Packing packing;
  packing.placements.resize(shapes.shapes.size());
  packing.used_columns = std::min(columns, 2);
  Orientations orientations;
  // One of the two is dropped when no remaining chart needs it.
  std::array<size_t, 2> charts_to_come{};
  for (const PackShape& shape : shapes.shapes) {
    ++charts_to_come[shape.gutter < kMaxGutter ? 0 : 1];
  }
  const PackShape* before = nullptr;
  int first_x = 1;
  for (const size_t i : packing_order(shapes)) {
    const PackShape& shape = shapes.shapes[i];
    // A chart that did not fit left of some column never will, since room only shrinks.
    if (before == nullptr || !same_outline(shapes, shape, *before)) {
      orientations.set(shapes.columns_of(shape), shape.height);
      first_x = 1;
    }
    const bool thin = shape.gutter < kMaxGutter;
    const Orientation* found = orientations.place(thin ? clear_of_own : clear_of_widest, first_x,
                                                  columns - 1 - shape.width);
    if (found == nullptr) {
      return std::nullopt;
    }
    packing.placements[i] = found->placement;
    first_x = found->placement.x;
    packing.used_columns = std::max(packing.used_columns, first_x + shape.width + 1);
    --charts_to_come[thin ? 0 : 1];
    if (charts_to_come[0] > 0) {
      take_with_gutter(clear_of_own, *found, shape.gutter);
    }
    if (charts_to_come[1] > 0) {
      take_with_gutter(clear_of_widest, *found, kMaxGutter);
    }
    before = &shape;
  }
  return packing;
}

}  // namespace snowbough::tree
