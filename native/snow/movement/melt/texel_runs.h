#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/parallel_for.h"

namespace snowbough::snow {

/// The most texels of a run; each run lies in one multiple of it.
inline constexpr size_t kTexelRun = 4096;

/// Calls visit(texel, place, count), on all cores, for runs of texels that lie side by side on the
/// map, the first at `place`. `places`: TexelTable::texel, ascending.
template <typename Visit>
void for_texel_runs(const std::vector<int32_t>& places, const Visit& visit) {
  base::for_each_item((places.size() + kTexelRun - 1) / kTexelRun, 1, [&](size_t run) {
    const size_t end = std::min(places.size(), (run + 1) * kTexelRun);
    for (size_t begin = run * kTexelRun; begin < end;) {
      const auto place = static_cast<size_t>(places[begin]);
      size_t last = end;
      // Usually all; else to the first gap.
      if (static_cast<size_t>(places[end - 1]) - place != end - 1 - begin) {
        last = begin + 1;
        while (static_cast<size_t>(places[last]) == place + last - begin) ++last;
      }
      visit(begin, place, last - begin);
      begin = last;
    }
  });
}

}  // namespace snowbough::snow
