#include "snow/surface_order.h"

#include <algorithm>
#include <numeric>

#include "shaders/snow_shared.h"

namespace snowbough::snow {
namespace {

/// `order` sorted by the keys of its entries (below `keys`), equal ones left in their order. `key`
/// takes an entry and its position in `order`.
template <typename Key>
std::vector<int32_t> sorted_by(const std::vector<int32_t>& order, int32_t keys, const Key& key) {
  std::vector<int32_t> begin(static_cast<size_t>(keys) + 1, 0);
  for (size_t at = 0; at < order.size(); ++at) {
    ++begin[static_cast<size_t>(key(order[at], at)) + 1];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<int32_t> sorted(order.size());
  for (size_t at = 0; at < order.size(); ++at) {
    sorted[static_cast<size_t>(begin[static_cast<size_t>(key(order[at], at))]++)] = order[at];
  }
  return sorted;
}

/// From here on the number of a texel's fragments makes no difference to the order.
constexpr int32_t kMostParts = 16;

}  // namespace

std::vector<int32_t> surface_order(const TexelTable& table) {
  const int32_t squares = (table.resolution + 31) / 32;
  std::vector<int32_t> order(table.texel.size());
  std::iota(order.begin(), order.end(), 0);
  order = sorted_by(order, squares * squares, [&](int32_t i, size_t) {
    const int32_t texel = table.texel[static_cast<size_t>(i)];
    return texel / table.resolution / 32 * squares + texel % table.resolution / 32;
  });
  order = sorted_by(order, table.chart_count,
                    [&](int32_t i, size_t) { return table.chart[static_cast<size_t>(i)]; });
  // A few neighbouring invocations walk along their fragments together: as long as the longest
  // takes.
  const auto groups = static_cast<int32_t>(order.size() / shared::kTexelGroup) + 1;
  return sorted_by(order, groups * kMostParts, [&](int32_t i, size_t at) {
    const int32_t* begin = &table.fragment_begin[static_cast<size_t>(i)];
    return static_cast<int32_t>(at / shared::kTexelGroup) * kMostParts +
           std::min(begin[1] - begin[0], kMostParts - 1);
  });
}

}  // namespace snowbough::snow
