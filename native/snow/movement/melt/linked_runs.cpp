#include "snow/movement/melt/linked_runs.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include "base/parallel_for.h"
#include "base/simd.h"

namespace snowbough::snow {
namespace {

/// Runs, and groups of them, that a thread filters at a time; and columns in a group.
constexpr size_t kRuns = 64;
constexpr size_t kGroups = 4;
constexpr size_t kSideBySide = 16;

/// Whether any value is not 0; -0 counts, which changes no result.
SNOWBOUGH_WIDE bool any_in(const float* values, size_t count) {
  uint32_t bits = 0;
  for (size_t i = 0; i < count; ++i) bits |= std::bit_cast<uint32_t>(values[i]);
  return bits != 0;
}

/// Calls work(first, last) for the places up to `radius` from those with any(place), of `count`;
/// in parts that do not touch, in order.
template <typename Any, typename Work>
void for_bands(size_t count, size_t radius, const Any& any, const Work& work) {
  for (size_t i = 0; i < count; ++i) {
    if (!any(i)) continue;
    const size_t first = i - std::min(i, radius);
    size_t end = i + 1;
    for (++i; i < std::min(count, end + 2 * radius); ++i) {
      if (any(i)) end = i + 1;
    }
    work(first, std::min(end + radius, count));
  }
}

/// A part of runs that lie `side` side by side, each of `whole` texels.
struct Band {
  size_t first, count, whole, side;
};

/// Divides the values of a band by the sizes of the squares around.
inline void divide_by_sizes(const Band& band, size_t radius, float* __restrict values) {
  const auto divide = [&](size_t from, size_t to) {
    if (from >= to) return;
    const size_t size = std::min(from + radius + 1, band.whole) - (from - std::min(from, radius));
    const float part = 1.0f / static_cast<float>(size);
    for (size_t k = (from - band.first) * band.side; k < (to - band.first) * band.side; ++k) {
      values[k] *= part;
    }
  };
  const size_t last = band.first + band.count;
  const size_t inner = std::clamp(band.whole > 2 * radius ? radius : last, band.first, last);
  for (size_t i = band.first; i < inner; ++i) divide(i, i + 1);
  const size_t outer = std::clamp(band.whole - std::min(radius, band.whole), inner, last);
  divide(inner, outer);
  for (size_t i = outer; i < last; ++i) divide(i, i + 1);
}

/// Sums over 2 * radius + 1 places, from sums over 1, 2, 4, ... places. `values`: with `radius`
/// zeros before and after; overwritten.
inline void sum_around(float* values, size_t count, size_t side, size_t radius,
                       float* __restrict sums) {
  const size_t width = 2 * radius + 1;
  std::copy_n(values, count * side, sums);
  size_t done = 1;
  for (size_t size = 2; size <= width; size *= 2) {
    const float* const next = values + size / 2 * side;
    const size_t last = (count + width - size) * side;
#pragma GCC ivdep
    for (size_t i = 0; i < last; ++i) values[i] += next[i];
    if ((width & size) == 0) continue;
    const float* const from = values + done * side;
    for (size_t i = 0; i < count * side; ++i) sums[i] += from[i];
    done += size;
  }
}

/// `values`: as above; `sums`: the result.
SNOWBOUGH_WIDE_FLAT void filter_band(bool spreads, const Band& band, size_t radius, float* values,
                                     float* __restrict sums) {
  const size_t around = radius * band.side;
  const size_t size = band.count * band.side;
  float* const own = values + around;
  std::fill(values, own, 0.0f);
  std::fill_n(own + size, around, 0.0f);
  if (spreads) divide_by_sizes(band, radius, own);
  sum_around(values, band.count, band.side, radius, sums);
  if (!spreads) divide_by_sizes(band, radius, sums);
}

}  // namespace

LinkedRuns::LinkedRuns(const TexelTable& table, const ReposeLinks& links) {
  const auto side = static_cast<size_t>(links.resolution);
  std::vector<int32_t> texel_of(side * side, -1);
  for (size_t i = 0; i < table.texel.size(); ++i) {
    texel_of[static_cast<size_t>(table.texel[i])] = static_cast<int32_t>(i);
  }
  by_column_.reserve(table.texel.size());
  for (const bool is_row : {true, false}) {
    // Links to the right, or upwards.
    const uint8_t link = is_row ? 1 : 2;
    std::vector<int32_t>& begins = is_row ? row_begin_ : column_begin_;
    int32_t count = 0;
    for (size_t line = 0; line < side; ++line) {
      bool is_linked = false;
      for (size_t along = 0; along < side; ++along) {
        const size_t column = is_row ? along : line;
        const size_t row = is_row ? line : along;
        const int32_t texel = texel_of[row * side + column];
        if (texel < 0) {
          is_linked = false;
          continue;
        }
        if (!is_linked) begins.push_back(count);
        ++count;
        if (!is_row) by_column_.push_back(texel);
        const int32_t cell = links.cell_at(static_cast<int32_t>(column), static_cast<int32_t>(row));
        is_linked = (links.forward[static_cast<size_t>(cell)] & link) != 0;
      }
    }
    begins.push_back(count);
  }
  find_groups();
}

void LinkedRuns::find_groups() {
  const size_t runs = column_begin_.size() - 1;
  const auto length = [&](size_t run) { return column_begin_[run + 1] - column_begin_[run]; };
  const auto is_beside = [&](size_t run, size_t other) {
    if (length(run) != length(other)) return false;
    const int32_t* const own = &by_column_[static_cast<size_t>(column_begin_[run])];
    const int32_t* const to = &by_column_[static_cast<size_t>(column_begin_[other])];
    return std::equal(own, own + length(run), to, [](int32_t a, int32_t b) { return b == a + 1; });
  };
  for (size_t run = 0; run < runs;) {
    groups_.push_back(static_cast<int32_t>(run));
    size_t end = run + 1;
    while (end < std::min(run + kSideBySide, runs) && is_beside(end - 1, end)) ++end;
    run = end == run + kSideBySide ? end : run + 1;
  }
  groups_.push_back(static_cast<int32_t>(runs));
}

void LinkedRuns::filter(bool spreads, int32_t radius, std::vector<float>& values) const {
  const auto reach = static_cast<size_t>(radius);
  // By kSideBySide texels: whether any is not 0.
  std::vector<uint8_t> any((values.size() + kSideBySide - 1) / kSideBySide, 0);
  base::for_each_item(row_begin_.size() - 1, kRuns, [&](size_t run) {
    const auto begin = static_cast<size_t>(row_begin_[run]);
    const size_t count = static_cast<size_t>(row_begin_[run + 1]) - begin;
    thread_local std::vector<float> memory;
    memory.resize(std::max(memory.size(), 2 * (count + reach)));
    const auto part = [&](size_t i) { return std::min(i * kSideBySide, count); };
    for_bands((count + kSideBySide - 1) / kSideBySide, (reach + kSideBySide - 1) / kSideBySide,
              [&](size_t i) { return any_in(&values[begin + part(i)], part(i + 1) - part(i)); },
              [&](size_t first, size_t last) {
                const Band band{part(first), part(last) - part(first), count, 1};
                float* const sums = memory.data() + band.count + 2 * reach;
                std::copy_n(&values[begin + band.first], band.count, memory.data() + reach);
                filter_band(spreads, band, reach, memory.data(), sums);
                std::copy_n(sums, band.count, &values[begin + band.first]);
                const size_t from = begin + band.first;
                for (size_t k = from / kSideBySide; k * kSideBySide < from + band.count; ++k) {
                  // Runs meet within a part.
                  std::atomic_ref(any[k]).store(1, std::memory_order_relaxed);
                }
              });
  });
  base::for_each_item(groups_.size() - 1, kGroups, [&](size_t group) {
    const auto begin = static_cast<size_t>(groups_[group]);
    const size_t side = static_cast<size_t>(groups_[group + 1]) - begin;
    const int32_t* const texel = &by_column_[static_cast<size_t>(column_begin_[begin])];
    const auto count = static_cast<size_t>(column_begin_[begin + 1] - column_begin_[begin]);
    thread_local std::vector<float> memory;
    memory.resize(std::max(memory.size(), 2 * (count + reach) * side));
    const auto is_any = [&](size_t i) {
      const auto own = static_cast<size_t>(texel[i]);
      return (any[own / kSideBySide] | any[(own + side - 1) / kSideBySide]) != 0;
    };
    for_bands(count, reach, is_any, [&](size_t first, size_t last) {
      const Band band{first, last - first, count, side};
      float* const own = memory.data() + reach * side;
      float* const sums = own + (band.count + reach) * side;
      const auto of_texel = [&](size_t i) {
        return &values[static_cast<size_t>(texel[first + i])];
      };
      for (size_t i = 0; i < band.count; ++i) std::copy_n(of_texel(i), side, own + i * side);
      filter_band(spreads, band, reach, memory.data(), sums);
      for (size_t i = 0; i < band.count; ++i) std::copy_n(sums + i * side, side, of_texel(i));
    });
  });
}

void LinkedRuns::average(int32_t radius, std::vector<float>& values) const {
  filter(false, radius, values);
}

void LinkedRuns::spread(int32_t radius, std::vector<float>& values) const {
  filter(true, radius, values);
}

}  // namespace snowbough::snow
