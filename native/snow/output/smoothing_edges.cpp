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

EdgeArrays Smoother::edge_arrays(Level& level) const {
  const auto count = static_cast<ptrdiff_t>(level.edges.size()) / 4;
  uint8_t* const first = level.edges.data() + level.margin;
  return {first, first + count, first + 2 * count, first + 3 * count};
}

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
    if (y == 0) return;
    // Into the run from bare cells below it.
    int32_t below = run.begin - grid.size;
    for (int32_t r = level.run_row[y - 1]; r < level.run_row[y]; ++r) {
      const auto [begin, end] = level.runs[r];
      if (end <= below) continue;
      open_upwards_run(height, closeness, edges.above, below, std::min(begin, run.end - grid.size));
      below = end;
    }
    open_upwards_run(height, closeness, edges.above, below, run.end - grid.size);
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
  std::vector<float> widest(level.edge_cells.size(), 0.0f);
  const auto note = [&](size_t band, int32_t cell, float closest) {
    level.edge_cells[band].push_back(cell);
    const float variance = std::max(least_variance_, third_squared(height[cell]));
    widest[band] = std::max(widest[band], variance * closest);
  };
  const bool may_have_edges = open_links(edges);
  for_each_row_band(grid, [&](size_t band, int32_t first, int32_t last) {
    level.edge_cells[band].clear();
    for (int32_t r = level.run_row[first]; r < level.run_row[last]; ++r) {
      const Run run = level.runs[r];
      if (may_have_edges) {
        mark_edges_run(edges, grid.size, run.begin, run.end);
        for_each_edge(edges.distance, run.begin, run.end,
                      [&](int32_t cell) { note(band, cell, closest_link(closeness, cell)); });
      } else {
        const auto count = static_cast<size_t>(run.end - run.begin);
        std::memset(edges.distance + run.begin, kFarFromEdge, count);
        std::memset(edges.next + run.begin, kFarFromEdge, count);
      }
    }
  });
  open_loose_links(0, [&](size_t band, int32_t cell, int32_t link) {
    if (std::fabs(height[cell]) < std::fabs(height[grid.link_other[link]])) return;
    edges.distance[cell] = 0;
    note(band, cell, grid.link_closeness[link]);
  });
  return *std::max_element(widest.begin(), widest.end());
}

/// One more link away from the edge.
void Smoother::spread_distance(EdgeArrays& edges) {
  const Level& level = levels_[0];
  const SmoothingLevel& grid = grid_.levels[0];
  for_each_row_band(grid, [&](size_t band, int32_t first, int32_t last) {
    for (int32_t r = level.run_row[first]; r < level.run_row[last]; ++r) {
      spread_distance_run(edges, grid.size, level.runs[r].begin, level.runs[r].end);
    }
    const OpenLinks& loose = level.loose[band];
    const OpenLink* link = loose.links.data();
    for (const OpenLinks::Cell& at : loose.cells) {
      uint8_t& own = edges.next[at.cell];
      for (const OpenLink* const end = loose.links.data() + at.end; link < end; ++link) {
        own = std::min(own, static_cast<uint8_t>(edges.distance[link->other] + 1));
      }
    }
  });
  std::swap(edges.distance, edges.next);
}

bool Smoother::shape_edges() {
  Level& level = levels_[0];
  const SmoothingLevel& grid = grid_.levels[0];
  EdgeArrays edges = edge_arrays(level);
  const float widest = find_edges(edges);
  find_banks();
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
