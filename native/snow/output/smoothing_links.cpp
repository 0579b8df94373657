// Smoother's links: which ones snow may cross, their conductance, and the diffusion stages.
#include <algorithm>
#include <utility>

#include "snow/output/smoothing.h"
#include "snow/output/smoothing_kernels.h"

namespace snowbough::snow {

void Smoother::open_loose_links(size_t number) {
  Level& level = levels_[number];
  const SmoothingLevel& grid = grid_.levels[number];
  const float* const height = level.at(level.height);
  for_each_row_band(grid, [&](size_t band, int32_t first, int32_t last) {
    auto& [cells, links] = level.loose[band];
    cells.clear();
    links.clear();
    for (int32_t y = first; y < last; ++y) {
      int32_t run = level.run_row[y];
      for (int32_t k = grid.link_row[y]; k < grid.link_row[y + 1]; ++k) {
        const int32_t cell = grid.link_cell[k];
        while (run < level.run_row[y + 1] && level.runs[run].end <= cell) ++run;
        if (run == level.run_row[y + 1]) break;
        if (cell < level.runs[run].begin || height[cell] == 0.0f) continue;
        const size_t before = links.size();
        for (int32_t t = grid.link_begin[k]; t < grid.link_begin[k + 1]; ++t) {
          const int32_t other = grid.link_other[t];
          if (is_open(height[cell], height[other])) {
            links.push_back({other, grid.link_weight[t], grid.link_closeness[t], 0.0f});
          }
        }
        if (links.size() > before) cells.push_back({cell, static_cast<int32_t>(links.size())});
      }
    }
  });
}

float Smoother::conduct(size_t number) {
  Level& level = levels_[number];
  const SmoothingLevel& grid = grid_.levels[number];
  const ConductanceTerms terms{least_variance_, done_below_[number], kStages};
  const float* const height = level.at(level.height);
  const float* const inverse = level.at(level.inverse_weight);
  std::vector<float> largest(static_cast<size_t>(grid.size), 0.0f);
  std::vector<float> loose_largest(level.loose.size(), 0.0f);
  for_each_row_band(grid, [&](size_t band, int32_t first, int32_t last) {
    for (int32_t y = first; y < last; ++y) {
      for (int32_t r = level.run_row[y]; r < level.run_row[y + 1]; ++r) {
        const Run run = level.runs[r];
        largest[y] = std::max(
            largest[y],
            conduct_run(height, inverse, {grid.to_right(), grid.upwards(), grid.size},
                        level.at(level.right), level.at(level.above), terms, run.begin, run.end));
      }
    }
    OpenLinks& loose = level.loose[band];
    size_t t = 0;
    for (const OpenLinks::Cell& at : loose.cells) {
      for (; t < static_cast<size_t>(at.end); ++t) {
        OpenLink& link = loose.links[t];
        const LinkConductance crosses =
            conductance(height[at.cell], height[link.other], inverse[at.cell], inverse[link.other],
                        link.closeness, terms);
        link.conductance = link.weight * crosses.conductance;
        loose_largest[band] = std::max(loose_largest[band], crosses.wanted);
      }
    }
  });
  return std::max(*std::max_element(largest.begin(), largest.end()),
                  *std::max_element(loose_largest.begin(), loose_largest.end()));
}

void Smoother::stages(size_t number, int32_t count) {
  Level& level = levels_[number];
  const SmoothingLevel& grid = grid_.levels[number];
  for (int32_t stage = 0; stage < count; ++stage) {
    const float* const from = level.at(level.height);
    float* const to = level.at(level.next);
    const float* const inverse = level.at(level.inverse_weight);
    for_each_row_band(grid, [&](size_t band, int32_t first, int32_t last) {
      for (int32_t r = level.run_row[first]; r < level.run_row[last]; ++r) {
        stage_run(from, to, level.at(level.right), level.at(level.above), inverse, grid.size,
                  level.runs[r].begin, level.runs[r].end);
      }
      const OpenLinks& loose = level.loose[band];
      const OpenLink* link = loose.links.data();
      for (const OpenLinks::Cell& at : loose.cells) {
        const float own = from[at.cell];
        float flux = 0.0f;
        for (const OpenLink* const end = loose.links.data() + at.end; link < end; ++link) {
          flux += link->conductance * (from[link->other] - own);
        }
        to[at.cell] += inverse[at.cell] * flux;
      }
    });
    std::swap(level.height, level.next);
  }
}

}  // namespace snowbough::snow
