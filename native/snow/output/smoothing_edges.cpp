// Smoother's shoulders: edges of snow beside bare ground, and every texel's distance from them.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "snow/output/smoothing.h"
#include "snow/output/smoothing_kernels.h"

namespace snowbough::snow {
namespace {

/// Maximum width of a shoulder in texels.
constexpr int32_t kWidestShoulder = 12;

}  // namespace

EdgeArrays Smoother::edge_arrays(Level& level) const {
  const auto count = static_cast<ptrdiff_t>(level.edges.size()) / 3;
  uint8_t* const first = level.edges.data() + level.margin;
  return {first, first + count, first + 2 * count};
}

/// Finds the open links; returns false if every cell linked to snow holds snow.
bool Smoother::open_links(const EdgeArrays& edges) {
  const Level& level = levels_[0];
  const SmoothingLevel& grid = grid_.levels[0];
  const float* const height = level.height.data() + level.margin;
  const ClosenessView closeness{grid.to_right(), grid.upwards(), grid.size};
  std::vector<uint8_t> closed(static_cast<size_t>(grid.size), 0);
  int64_t covered = 0;
  for (const Run& run : level.runs) covered += run.end - run.begin;
  for_each_run(0, [&](Run run) {
    const int32_t y = run.begin / grid.size;
    if (open_links_run(height, closeness, edges, run.begin, run.end)) {
      closed[static_cast<size_t>(y)] = 1;
    }
    if (y == 0) return;
    // Links from bare cells below lead into the run.
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

/// Sets the distance of edge cells to 0. Returns the largest variance over distance^2 there; 0
/// without an edge.
float Smoother::find_edges(const EdgeArrays& edges) {
  Level& level = levels_[0];
  const SmoothingLevel& grid = grid_.levels[0];
  const float* const height = level.at(level.height);
  const ClosenessView closeness{grid.to_right(), grid.upwards(), grid.size};
  std::vector<float> widest(level.edge_cells.size(), 0.0f);
  const auto note = [&](size_t band, int32_t cell, float closest) {
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
        for_each_edge(edges.distance, run.begin, run.end, [&](int32_t cell) {
          level.edge_cells[band].push_back(cell);
          note(band, cell, closest_link(closeness, cell));
        });
      } else {
        const auto count = static_cast<size_t>(run.end - run.begin);
        std::memset(edges.distance + run.begin, kFarFromEdge, count);
      }
    }
  });
  open_loose_links(0, [&](size_t band, int32_t cell, int32_t link) {
    if (std::fabs(height[cell]) < std::fabs(height[grid.link_other[link]])) return;
    if (std::exchange(edges.distance[cell], 0) != 0) level.edge_cells[band].push_back(cell);
    note(band, cell, grid.link_closeness[link]);
  });
  return *std::max_element(widest.begin(), widest.end());
}

/// Propagates the distance from the edge cells to all cells less than `rounds` open links away, and
/// returns these.
std::vector<int32_t> Smoother::spread_distance(const EdgeArrays& edges, int32_t rounds) const {
  const Level& level = levels_[0];
  const SmoothingLevel& grid = grid_.levels[0];
  const float* const height = level.at(level.height);
  const int32_t size = grid.size;
  std::vector<int32_t> cells;
  for (const std::vector<int32_t>& own : level.edge_cells) {
    cells.insert(cells.end(), own.begin(), own.end());
  }
  size_t begun = 0;
  for (int32_t links = 1; links < rounds; ++links) {
    const auto reach = [&](int32_t cell) {
      if (edges.distance[cell] <= links) return;
      edges.distance[cell] = static_cast<uint8_t>(links);
      cells.push_back(cell);
    };
    for (const size_t last = cells.size(); begun < last; ++begun) {
      const int32_t i = cells[begun];
      if (edges.right[i] == kOpenLink) reach(i + 1);
      if (edges.right[i - 1] == kOpenLink) reach(i - 1);
      if (edges.above[i] == kOpenLink) reach(i + size);
      if (edges.above[i - size] == kOpenLink) reach(i - size);
      grid.for_each_link(i, [&](int32_t other) {
        if (is_open(height[i], height[other])) reach(other);
      });
    }
  }
  return cells;
}

bool Smoother::shape_edges() {
  Level& level = levels_[0];
  const SmoothingLevel& grid = grid_.levels[0];
  const EdgeArrays edges = edge_arrays(level);
  const float widest = find_edges(edges);
  find_feet();
  if (widest <= 0.0f) return false;
  const int32_t rounds =
      std::min(kWidestShoulder, static_cast<int32_t>(std::ceil(kShoulder * std::sqrt(widest))));
  const ClosenessView closeness{grid.to_right(), grid.upwards(), grid.size};
  for (const int32_t i : spread_distance(edges, rounds)) {
    level.at(level.inverse_weight)[i] /=
        shoulder_profile(edges.distance[i], level.at(level.height)[i], closest_link(closeness, i),
                         least_variance_, static_cast<float>(rounds));
  }
  return true;
}

void Smoother::divide_by_profile() {
  Level& level = levels_[0];
  for_each_run(0, [&](Run run) {
    divide_run(level.at(level.height), grid_.inverse_area.data(), level.at(level.inverse_weight),
               run.begin, run.end);
  });
}

}  // namespace snowbough::snow
