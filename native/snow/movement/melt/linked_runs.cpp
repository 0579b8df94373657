#include "snow/movement/melt/linked_runs.h"

#include <algorithm>

#include "base/parallel_for.h"

namespace snowbough::snow {
namespace {

/// Runs that a thread filters at a time.
constexpr size_t kRuns = 64;

bool is_zero(const float* values, size_t count) {
  return std::all_of(values, values + count, [](float value) { return value == 0.0f; });
}

/// Replaces values by moving averages.
void average_run(float* values, size_t count, size_t radius, std::vector<double>& sums) {
  sums.resize(count + 1);
  sums[0] = 0.0;
  for (size_t i = 0; i < count; ++i) sums[i + 1] = sums[i] + static_cast<double>(values[i]);
  for (size_t i = 0; i < count; ++i) {
    const size_t begin = i - std::min(i, radius);
    const size_t end = std::min(i + radius + 1, count);
    values[i] = static_cast<float>((sums[end] - sums[begin]) / static_cast<double>(end - begin));
  }
}

/// Distributes each value over its neighbours.
void spread_run(float* values, size_t count, size_t radius, std::vector<double>& sums) {
  // What begins and ends to be added at each place.
  sums.assign(count + 1, 0.0);
  for (size_t i = 0; i < count; ++i) {
    const size_t begin = i - std::min(i, radius);
    const size_t end = std::min(i + radius + 1, count);
    const double part = static_cast<double>(values[i]) / static_cast<double>(end - begin);
    sums[begin] += part;
    sums[end] -= part;
  }
  double sum = 0.0;
  for (size_t i = 0; i < count; ++i) {
    sum += sums[i];
    values[i] = static_cast<float>(std::max(sum, 0.0));
  }
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
}

template <typename Filter>
void LinkedRuns::filter(std::vector<float>& values, const Filter& filter) const {
  const auto for_runs = [&](const std::vector<int32_t>& begins, const auto& work) {
    base::for_each_item(begins.size() - 1, kRuns, [&](size_t run) {
      const auto begin = static_cast<size_t>(begins[run]);
      work(begin, static_cast<size_t>(begins[run + 1]) - begin);
    });
  };
  for_runs(row_begin_, [&](size_t begin, size_t count) {
    thread_local std::vector<double> sums;
    if (!is_zero(&values[begin], count)) filter(&values[begin], count, sums);
  });
  for_runs(column_begin_, [&](size_t begin, size_t count) {
    thread_local std::vector<double> sums;
    thread_local std::vector<float> run;
    run.resize(count);
    for (size_t i = 0; i < count; ++i) {
      run[i] = values[static_cast<size_t>(by_column_[begin + i])];
    }
    if (is_zero(run.data(), count)) return;
    filter(run.data(), count, sums);
    for (size_t i = 0; i < count; ++i) {
      values[static_cast<size_t>(by_column_[begin + i])] = run[i];
    }
  });
}

void LinkedRuns::average(int32_t radius, std::vector<float>& values) const {
  filter(values, [&](float* run, size_t count, std::vector<double>& sums) {
    average_run(run, count, static_cast<size_t>(radius), sums);
  });
}

void LinkedRuns::spread(int32_t radius, std::vector<float>& values) const {
  filter(values, [&](float* run, size_t count, std::vector<double>& sums) {
    spread_run(run, count, static_cast<size_t>(radius), sums);
  });
}

}  // namespace snowbough::snow
