#include "snow/movement/melt/linked_runs.h"

#include <algorithm>

#include "base/parallel_for.h"
#include "base/simd.h"

namespace snowbough::snow {
namespace {

/// Runs, and groups of them, that a thread filters at a time; and columns in a group.
constexpr size_t kRuns = 64;
constexpr size_t kGroups = 4;
constexpr size_t kSideBySide = 16;

bool is_zero(const float* values, size_t count) {
  return std::all_of(values, values + count, [](float value) { return value == 0.0f; });
}

/// Divides the values at the places of `side` runs side by side by the sizes of the squares around.
inline void divide_by_sizes(float* __restrict values, size_t count, size_t side, size_t radius) {
  const auto divide = [&](size_t first, size_t last) {
    const size_t size = std::min(first + radius + 1, count) - (first - std::min(first, radius));
    const float part = 1.0f / static_cast<float>(size);
    for (size_t k = first * side; k < last * side; ++k) values[k] *= part;
  };
  const size_t inner = count > 2 * radius ? radius : count;
  for (size_t i = 0; i < inner; ++i) divide(i, i + 1);
  if (inner == count) return;
  divide(inner, count - radius);
  for (size_t i = count - radius; i < count; ++i) divide(i, i + 1);
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
SNOWBOUGH_WIDE_FLAT void filter_runs(bool spreads, size_t count, size_t side, size_t radius,
                                     float* values, float* __restrict sums) {
  float* const own = values + radius * side;
  std::fill(values, own, 0.0f);
  std::fill_n(own + count * side, radius * side, 0.0f);
  if (spreads) divide_by_sizes(own, count, side, radius);
  sum_around(values, count, side, radius, sums);
  if (!spreads) divide_by_sizes(sums, count, side, radius);
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
  // `copy` visits the values of runs side by side, row by row.
  const auto filter_side = [&](size_t count, size_t side, const auto& copy) {
    thread_local std::vector<float> memory;
    memory.resize(std::max(memory.size(), 2 * (count + reach) * side));
    float* const own = memory.data() + reach * side;
    float* const sums = own + (count + reach) * side;
    copy([&](size_t i, float* of_texels) { std::copy_n(of_texels, side, own + i * side); });
    if (is_zero(own, count * side)) return;
    filter_runs(spreads, count, side, reach, memory.data(), sums);
    copy([&](size_t i, float* of_texels) { std::copy_n(sums + i * side, side, of_texels); });
  };
  base::for_each_item(row_begin_.size() - 1, kRuns, [&](size_t run) {
    const auto begin = static_cast<size_t>(row_begin_[run]);
    const size_t count = static_cast<size_t>(row_begin_[run + 1]) - begin;
    thread_local std::vector<float> memory;
    if (is_zero(&values[begin], count)) return;
    memory.resize(std::max(memory.size(), count + 2 * reach));
    std::copy_n(&values[begin], count, memory.data() + reach);
    filter_runs(spreads, count, 1, reach, memory.data(), &values[begin]);
  });
  base::for_each_item(groups_.size() - 1, kGroups, [&](size_t group) {
    const auto first = static_cast<size_t>(groups_[group]);
    const size_t side = static_cast<size_t>(groups_[group + 1]) - first;
    const int32_t* const texel = &by_column_[static_cast<size_t>(column_begin_[first])];
    const auto count = static_cast<size_t>(column_begin_[first + 1] - column_begin_[first]);
    filter_side(count, side, [&](const auto& visit) {
      for (size_t i = 0; i < count; ++i) visit(i, &values[static_cast<size_t>(texel[i])]);
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
