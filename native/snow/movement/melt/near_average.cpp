#include "snow/movement/melt/near_average.h"

#include <algorithm>
#include <utility>

#include "base/parallel_for.h"

namespace snowbough::snow {
namespace {

/// Replaces the values of linked texels in a row, or a column, by moving averages.
void average_run(const std::vector<int32_t>& run, int32_t radius, std::vector<double>& sums,
                 std::vector<float>& values) {
  const auto count = static_cast<int32_t>(run.size());
  sums.assign(run.size() + 1, 0.0);
  for (size_t i = 0; i < run.size(); ++i) {
    sums[i + 1] = sums[i] + static_cast<double>(values[static_cast<size_t>(run[i])]);
  }
  for (int32_t i = 0; i < count; ++i) {
    const int32_t begin = std::max(i - radius, 0);
    const int32_t end = std::min(i + radius + 1, count);
    values[static_cast<size_t>(run[static_cast<size_t>(i)])] = static_cast<float>(
        (sums[static_cast<size_t>(end)] - sums[static_cast<size_t>(begin)]) / (end - begin));
  }
}

}  // namespace

std::vector<float> near_average(const TexelTable& table, const ReposeLinks& links, int32_t radius,
                                std::vector<float> values) {
  const auto side = static_cast<size_t>(table.resolution);
  std::vector<int32_t> texel_of(side * side, -1);
  for (size_t i = 0; i < table.texel.size(); ++i) {
    texel_of[static_cast<size_t>(table.texel[i])] = static_cast<int32_t>(i);
  }
  // Links to the right, then upwards.
  for (const uint8_t link : {uint8_t{1}, uint8_t{2}}) {
    base::for_each_item(side, 16, [&](size_t line) {
      std::vector<int32_t> run;
      std::vector<double> sums;
      const auto finish = [&] {
        if (run.size() > 1) average_run(run, radius, sums, values);
        run.clear();
      };
      for (size_t along = 0; along < side; ++along) {
        const size_t column = link == 1 ? along : line;
        const size_t row = link == 1 ? line : along;
        const int32_t texel = texel_of[row * side + column];
        if (texel < 0) {
          finish();
          continue;
        }
        run.push_back(texel);
        const int32_t cell = links.cell_at(static_cast<int32_t>(column), static_cast<int32_t>(row));
        if ((links.forward[static_cast<size_t>(cell)] & link) == 0) finish();
      }
      finish();
    });
  }
  return values;
}

}  // namespace snowbough::snow
