#include "snow/scene/group_triangles.h"

#include <algorithm>
#include <utility>

#include "shaders/lib/snow_shared.h"

namespace snowbough::snow {
namespace {

using shared::kTexelGroup;

}  // namespace

void add_group_triangles(const TexelTable& table, const std::vector<int32_t>& order,
                         uint32_t first_triangle, GroupTriangles& groups) {
  int32_t last = -1;
  for (const int32_t triangle : table.fragment_triangle) last = std::max(last, triangle);
  // Per triangle: the last group, counted from 1, that contains it.
  std::vector<int32_t> noted_in(static_cast<size_t>(last) + 1, 0);
  int32_t group = 0;
  for (size_t begin = 0; begin < order.size(); begin += kTexelGroup) {
    ++group;
    const size_t before = groups.triangles.size();
    for (size_t at = begin; at < std::min<size_t>(order.size(), begin + kTexelGroup); ++at) {
      const auto i = static_cast<size_t>(order[at]);
      for (int32_t f = table.fragment_begin[i]; f < table.fragment_begin[i + 1]; ++f) {
        const auto triangle = static_cast<size_t>(table.fragment_triangle[static_cast<size_t>(f)]);
        if (std::exchange(noted_in[triangle], group) == group) continue;
        groups.triangles.push_back(static_cast<uint32_t>(triangle) + first_triangle);
      }
    }
    std::sort(groups.triangles.begin() + static_cast<ptrdiff_t>(before), groups.triangles.end());
    groups.begin.push_back(static_cast<uint32_t>(groups.triangles.size()));
  }
}

}  // namespace snowbough::snow
