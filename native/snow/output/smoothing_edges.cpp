// Smoother's shoulders: where snow ends beside bare ground, and how far away every texel is.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "snow/output/smoothing.h"
#include "snow/output/smoothing_kernels.h"

namespace snowbough::snow {
namespace {

/// A profile reaches at most so many texels in from the edge.
constexpr int32_t kWidestShoulder = 12;

}  // namespace

/// Says which links are open; returns false where every cell that is linked to snow holds some.
bool Smoother::open_links(const EdgeArrays& edges) {
  const Level& level = levels_[0];
  const SmoothingLevel& grid = grid_.levels[0];
  const float* const height = level.height.data() + level.margin;
  const ClosenessView closeness{grid.to_right(), grid.upwards(), grid.size};
  std::vector<uint8_t> closed(static_cast<size_t>(grid.size), 0);
  int64_t covered = 0;
  for (const Run& run : level.runs) covered += run.end - run.begin;
  for_each_run(0, [&](int32_t y, Run run) {
    if (open_links_run(height, closeness, edges, run.begin, run.end)) {
      closed[static_cast<size_t>(y)] = 1;
    }
  });
  return covered < int64_t{grid.size} * grid.size ||
         std::any_of(closed.begin(), closed.end(), [](uint8_t row) { return row != 0; });
}

/// Sets the distance of the cells at an edge to 0. Returns the largest variance over distance^2
/// there; 0 where there is no edge.
float Smoother::find_edges(const EdgeArrays& edges) {
  Level& level = levels_[0];
  const SmoothingLevel& grid = grid_.levels[0];
  const float* const height = level.at(level.height);
  const ClosenessView closeness{grid.to_right(), grid.upwards(), grid.size};
  std::vector<float> widest(static_cast<size_t>(grid.size), 0.0f);
  const bool may_have_edges = open_links(edges);
  if (may_have_edges) {
    for_each_run(0, [&](int32_t y, Run run) {
      float& own = widest[static_cast<size_t>(y)];
      own = std::max(own,
                     find_edges_run(height, closeness, least_variance_, edges, run.begin, run.end));
    });
  } else {
    for_each_run(0, [&](int32_t, Run run) {
      std::memset(edges.distance + run.begin, kFarFromEdge,
                  static_cast<size_t>(run.end - run.begin));
      std::memset(edges.next + run.begin, kFarFromEdge, static_cast<size_t>(run.end - run.begin));
    });
  }
  for (size_t k = 0; k < grid.link_cell.size(); ++k) {
    const int32_t cell = grid.link_cell[k];
    for (int32_t t = grid.link_begin[k]; t < grid.link_begin[k + 1]; ++t) {
      const float other = height[grid.link_other[t]];
      const bool open = is_open(height[cell], other);
      level.loose[t] = open ? 1.0f : 0.0f;
      if (open || height[cell] == 0.0f || std::fabs(height[cell]) < std::fabs(other)) continue;
      edges.distance[cell] = 0;
      const float variance = std::max(least_variance_, third_squared(height[cell]));
      float& own = widest[static_cast<size_t>(cell / grid.size)];
      own = std::max(own, variance * grid.link_closeness[t]);
    }
  }
  return *std::max_element(widest.begin(), widest.end());
}

/// One more link away from the edge.
void Smoother::spread_distance(EdgeArrays& edges) {
  const Level& level = levels_[0];
  const SmoothingLevel& grid = grid_.levels[0];
  for_each_row_band(grid, [&](int32_t first, int32_t last) {
    for (int32_t r = level.run_row[first]; r < level.run_row[last]; ++r) {
      spread_distance_run(edges, grid.size, level.runs[r].begin, level.runs[r].end);
    }
    for (int32_t k = grid.link_row[first]; k < grid.link_row[last]; ++k) {
      uint8_t& own = edges.next[grid.link_cell[k]];
      for (int32_t t = grid.link_begin[k]; t < grid.link_begin[k + 1]; ++t) {
        if (level.loose[t] == 0.0f) continue;
        own = std::min(own, static_cast<uint8_t>(edges.distance[grid.link_other[t]] + 1));
      }
    }
  });
  std::swap(edges.distance, edges.next);
}

bool Smoother::shape_edges() {
  Level& level = levels_[0];
  const SmoothingLevel& grid = grid_.levels[0];
  // The array is not in use yet; its bytes hold distances and which links are open.
  auto* const bytes = reinterpret_cast<uint8_t*>(level.next.data());
  const auto count = static_cast<ptrdiff_t>(level.next.size());
  EdgeArrays edges{bytes + level.margin, bytes + count + level.margin,
                   bytes + 2 * count + level.margin, bytes + 3 * count + level.margin};
  std::memset(bytes, 0, static_cast<size_t>(4 * count));
  const float widest = find_edges(edges);
  if (widest > 0.0f) {
    const int32_t rounds =
        std::min(kWidestShoulder, static_cast<int32_t>(std::ceil(kShoulder * std::sqrt(widest))));
    for (int32_t round = 0; round < rounds; ++round) spread_distance(edges);
    for_each_run(0, [&](int32_t, Run run) {
      shape_run(level.at(level.height), {grid.to_right(), grid.upwards(), grid.size},
                least_variance_, static_cast<float>(rounds), edges.distance,
                level.at(level.inverse_weight), run.begin, run.end);
    });
  }
  std::fill(level.next.begin(), level.next.end(), 0.0f);
  return widest > 0.0f;
}

void Smoother::divide_by_profile() {
  Level& level = levels_[0];
  for_each_run(0, [&](int32_t, Run run) {
    divide_run(level.at(level.height), grid_.inverse_area.data(), level.at(level.inverse_weight),
               run.begin, run.end);
  });
}

}  // namespace snowbough::snow
