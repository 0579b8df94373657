#include "snow/movement/melt/linked_runs.h"

#include <algorithm>
#include <array>

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

/// Where the square around a place of a run begins and ends.
struct Reach {
  size_t begin, end;

  Reach(size_t i, size_t count, size_t radius)
      : begin(i - std::min(i, radius)), end(std::min(i + radius + 1, count)) {}
};

/// Calls visit(first, last) for the places of a run in parts with squares of one size.
template <typename Visit>
inline void for_sizes(size_t count, size_t radius, const Visit& visit) {
  const size_t inner = count > 2 * radius ? radius : count;
  for (size_t i = 0; i < inner; ++i) visit(i, i + 1);
  if (inner == count) return;
  visit(inner, count - radius);
  for (size_t i = count - radius; i < count; ++i) visit(i, i + 1);
}

/// Replaces the values of `kSide` runs side by side by moving averages. `sums`: kSide * (count +
/// 1).
template <size_t kSide>
inline void average_runs(float* __restrict values, size_t count, size_t radius,
                         double* __restrict sums) {
  for (size_t k = 0; k < kSide; ++k) sums[k] = 0.0;
  for (size_t i = 0; i < count * kSide; ++i) {
    sums[i + kSide] = sums[i] + static_cast<double>(values[i]);
  }
  for_sizes(count, radius, [&](size_t first, size_t last) {
    const Reach reach(first, count, radius);
    const auto size = static_cast<double>(reach.end - reach.begin);
    const double* const high = sums + reach.end * kSide;
    const double* const low = sums + reach.begin * kSide;
    float* const own = values + first * kSide;
    for (size_t i = 0; i < (last - first) * kSide; ++i) {
      own[i] = static_cast<float>((high[i] - low[i]) / size);
    }
  });
}

/// Distributes each value of `kSide` runs side by side over its neighbours. `parts`: as above.
template <size_t kSide>
inline void spread_runs(float* __restrict values, size_t count, size_t radius,
                        double* __restrict parts) {
  for_sizes(count, radius, [&](size_t first, size_t last) {
    const Reach reach(first, count, radius);
    const auto size = static_cast<double>(reach.end - reach.begin);
    for (size_t i = first * kSide; i < last * kSide; ++i) {
      parts[i] = static_cast<double>(values[i]) / size;
    }
  });
  std::array<double, kSide> sum{};
  for (size_t i = 0; i < std::min(radius, count); ++i) {
    for (size_t k = 0; k < kSide; ++k) sum[k] += parts[i * kSide + k];
  }
  for (size_t i = 0; i < count; ++i) {
    const bool begins = i + radius < count;
    const bool ends = i > radius;
    const double* const come = parts + (begins ? i + radius : 0) * kSide;
    const double* const gone = parts + (ends ? i - radius - 1 : 0) * kSide;
    if (begins && ends) {
      for (size_t k = 0; k < kSide; ++k) sum[k] += come[k] - gone[k];
    } else if (begins) {
      for (size_t k = 0; k < kSide; ++k) sum[k] += come[k];
    } else if (ends) {
      for (size_t k = 0; k < kSide; ++k) sum[k] -= gone[k];
    }
    for (size_t k = 0; k < kSide; ++k) {
      values[i * kSide + k] = static_cast<float>(std::max(sum[k], 0.0));
    }
  }
}

struct Average {
  SNOWBOUGH_WIDE_FLAT static void one(float* values, size_t count, size_t radius, double* sums) {
    average_runs<1>(values, count, radius, sums);
  }
  SNOWBOUGH_WIDE_FLAT static void group(float* values, size_t count, size_t radius, double* sums) {
    average_runs<kSideBySide>(values, count, radius, sums);
  }
};

struct Spread {
  SNOWBOUGH_WIDE_FLAT static void one(float* values, size_t count, size_t radius, double* sums) {
    spread_runs<1>(values, count, radius, sums);
  }
  SNOWBOUGH_WIDE_FLAT static void group(float* values, size_t count, size_t radius, double* sums) {
    spread_runs<kSideBySide>(values, count, radius, sums);
  }
};

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

template <typename Filter>
void LinkedRuns::filter(int32_t radius, std::vector<float>& values) const {
  const auto reach = static_cast<size_t>(radius);
  base::for_each_item(row_begin_.size() - 1, kRuns, [&](size_t run) {
    thread_local std::vector<double> sums;
    const auto begin = static_cast<size_t>(row_begin_[run]);
    const size_t count = static_cast<size_t>(row_begin_[run + 1]) - begin;
    if (is_zero(&values[begin], count)) return;
    sums.resize(std::max(sums.size(), count + 1));
    Filter::one(&values[begin], count, reach, sums.data());
  });
  base::for_each_item(groups_.size() - 1, kGroups, [&](size_t group) {
    thread_local std::vector<double> sums;
    thread_local std::vector<float> runs;
    const auto first = static_cast<size_t>(groups_[group]);
    const size_t side = static_cast<size_t>(groups_[group + 1]) - first;
    const int32_t* const texel = &by_column_[static_cast<size_t>(column_begin_[first])];
    const auto count = static_cast<size_t>(column_begin_[first + 1] - column_begin_[first]);
    runs.resize(count * side);
    for (size_t i = 0; i < count; ++i) {
      std::copy_n(&values[static_cast<size_t>(texel[i])], side, &runs[i * side]);
    }
    if (is_zero(runs.data(), runs.size())) return;
    sums.resize(std::max(sums.size(), (count + 1) * side));
    (side == 1 ? Filter::one : Filter::group)(runs.data(), count, reach, sums.data());
    for (size_t i = 0; i < count; ++i) {
      std::copy_n(&runs[i * side], side, &values[static_cast<size_t>(texel[i])]);
    }
  });
}

void LinkedRuns::average(int32_t radius, std::vector<float>& values) const {
  filter<Average>(radius, values);
}

void LinkedRuns::spread(int32_t radius, std::vector<float>& values) const {
  filter<Spread>(radius, values);
}

}  // namespace snowbough::snow
