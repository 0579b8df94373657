#include "snow/surface_order.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "shaders/snow_shared.h"

namespace snowbough::snow {
namespace {

/// `order` sorted by `key` (below `keys`), equal ones left in their order.
template <typename Key>
std::vector<int32_t> sorted_by(const std::vector<int32_t>& order, int32_t keys, const Key& key) {
  std::vector<int32_t> begin(static_cast<size_t>(keys) + 1, 0);
  for (const int32_t i : order) {
    ++begin[static_cast<size_t>(key(i)) + 1];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<int32_t> sorted(order.size());
  for (const int32_t i : order) {
    sorted[static_cast<size_t>(begin[static_cast<size_t>(key(i))]++)] = i;
  }
  return sorted;
}

}  // namespace

std::vector<int32_t> surface_order(const TexelTable& table) {
  const int32_t squares = (table.resolution + 31) / 32;
  std::vector<int32_t> order(table.texel.size());
  std::iota(order.begin(), order.end(), 0);
  order = sorted_by(order, squares * squares, [&](int32_t i) {
    const int32_t texel = table.texel[static_cast<size_t>(i)];
    return texel / table.resolution / 32 * squares + texel % table.resolution / 32;
  });
  order = sorted_by(order, table.chart_count,
                    [&](int32_t i) { return table.chart[static_cast<size_t>(i)]; });
  // A few neighbouring invocations walk along their parts together: as long as the longest takes.
  const auto parts = [&](int32_t i) {
    const auto at = static_cast<size_t>(i);
    return table.fragment_begin[at + 1] - table.fragment_begin[at];
  };
  for (auto begin = order.begin(); begin != order.end();) {
    const auto end =
        begin + std::min<std::ptrdiff_t>(std::ptrdiff_t{shared::kTexelGroup}, order.end() - begin);
    std::stable_sort(begin, end, [&](int32_t a, int32_t b) { return parts(a) < parts(b); });
    begin = end;
  }
  return order;
}

}  // namespace snowbough::snow
