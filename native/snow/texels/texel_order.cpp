#include "snow/texels/texel_order.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

#include "base/group_by_key.h"
#include "shaders/lib/snow_shared.h"

namespace snowbough::snow {
namespace {

/// Consecutive texels of a row, of one chart and in one square.
struct Run {
  int32_t first;
  int32_t count;
  int32_t square;
  int32_t chart;
};

std::vector<Run> find_runs(const TexelTable& table) {
  const int32_t squares = (table.resolution + 31) / 32;
  std::vector<Run> runs;
  for (size_t i = 0; i < table.texel.size(); ++i) {
    const int32_t texel = table.texel[i];
    const int32_t column = texel % table.resolution;
    const bool continues = !runs.empty() && column % 32 != 0 && table.texel[i - 1] == texel - 1 &&
                           table.chart[i] == runs.back().chart;
    if (continues) {
      ++runs.back().count;
    } else {
      const int32_t square = texel / table.resolution / 32 * squares + column / 32;
      runs.push_back({static_cast<int32_t>(i), 1, square, table.chart[i]});
    }
  }
  return runs;
}

/// Stable sort by the runs' keys (below `keys`).
template <typename Key>
std::vector<Run> sorted_by(const std::vector<Run>& runs, int32_t keys, const Key& key) {
  const auto for_runs = [&](const auto& visit) {
    for (const Run& run : runs) visit(key(run), run);
  };
  std::vector<int32_t> begin;
  std::vector<Run> sorted;
  base::group_by_key(static_cast<size_t>(keys), for_runs, begin, sorted);
  return sorted;
}

/// Numbers of fragments from this on count as equal.
constexpr int32_t kMaxParts = 16;

/// Stable sort of a work group's texels by their number of fragments.
void sort_group(const TexelTable& table, std::span<int32_t> group) {
  const auto parts = [&](int32_t i) {
    const int32_t* begin = &table.fragment_begin[static_cast<size_t>(i)];
    return static_cast<size_t>(std::min(begin[1] - begin[0], kMaxParts - 1));
  };
  std::array<size_t, kMaxParts + 1> begin{};
  for (const int32_t i : group) ++begin[parts(i) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::array<int32_t, shared::kTexelGroup> sorted;
  for (const int32_t i : group) sorted[begin[parts(i)]++] = i;
  std::copy_n(sorted.begin(), group.size(), group.begin());
}

}  // namespace

std::vector<int32_t> texel_order(const TexelTable& table) {
  const int32_t squares = (table.resolution + 31) / 32;
  std::vector<Run> runs = find_runs(table);
  runs = sorted_by(runs, squares * squares, [](const Run& run) { return run.square; });
  runs = sorted_by(runs, table.chart_count, [](const Run& run) { return run.chart; });
  std::vector<int32_t> order;
  order.reserve(table.texel.size());
  for (const Run& run : runs) {
    for (int32_t i = run.first; i < run.first + run.count; ++i) order.push_back(i);
  }
  // A few neighbouring invocations loop over their fragments together, as long as the longest
  // takes.
  for (size_t begin = 0; begin < order.size(); begin += shared::kTexelGroup) {
    const size_t count = std::min<size_t>(shared::kTexelGroup, order.size() - begin);
    sort_group(table, std::span(order).subspan(begin, count));
  }
  return order;
}

}  // namespace snowbough::snow
