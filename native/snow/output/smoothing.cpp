#include "snow/output/smoothing.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "base/parallel_for.h"
#include "snow/output/smoothing_kernels.h"

namespace snowbough::snow {
namespace {

constexpr ptrdiff_t kMargin = 32;
/// Bare cells of a row are skipped in blocks of this size.
constexpr int32_t kBlock = 16;
/// Levels up to this size run on one thread.
constexpr int32_t kSmallLevel = 512;

/// Half the variance in cells^2 that merging a block's cells adds.
constexpr float kBlockSpread = 0.25f;

/// Half a link's variance over distance^2 that levels finer than `level` provide.
float done_below(size_t level) {
  return (kStages * kStageShare + kBlockSpread) / 3.0f *
         (1.0f - std::pow(0.25f, static_cast<float>(level)));
}

BlockRows block_rows(const SmoothingLevel& grid, const float* inverse, int32_t first) {
  return {{inverse + first, inverse + first + grid.size},
          {grid.joins.data() + first, grid.joins.data() + first + grid.size}};
}

}  // namespace

void check_smoothing(const SmoothingSettings& settings) {
  if (!(settings.blur_radius >= 0.0f) || !std::isfinite(settings.blur_radius)) {
    throw std::invalid_argument("blur_radius must be 0 metres or more");
  }
}

Smoother::Smoother(const SmoothingGrid& grid, const SmoothingSettings& settings, int32_t threads)
    : grid_(grid),
      least_variance_(settings.blur_radius * settings.blur_radius),
      threads_(std::max(1, threads)) {
  check_smoothing(settings);
  for (size_t level = 0; level < grid.levels.size(); ++level) {
    done_below_.push_back(done_below(level));
  }
}

/// Pool of the arrays of finished maps, for maps of the same size: touching new memory for the
/// first time costs more than a pass over a map. Thread-safe.
class Smoother::Workspace {
 public:
  static Workspace& shared() {
    static Workspace workspace;
    return workspace;
  }

  /// Levels for a map of `size` texels per side; empty if the pool has none.
  std::vector<Level> acquire(int32_t size) {
    const std::scoped_lock lock(mutex_);
    const auto found = std::find_if(kept_.begin(), kept_.end(),
                                    [size](const auto& work) { return work.first == size; });
    if (found == kept_.end()) return {};
    std::vector<Level> levels = std::move(found->second);
    kept_.erase(found);
    return levels;
  }

  void release(int32_t size, std::vector<Level>&& levels) {
    std::vector<Level> oldest;  // released behind the lock
    const std::scoped_lock lock(mutex_);
    if (kept_.size() == kMaxKept) {
      oldest = std::move(kept_.front().second);
      kept_.erase(kept_.begin());
    }
    kept_.emplace_back(size, std::move(levels));
  }

 private:
  /// Number of maps processed at the same time.
  static constexpr size_t kMaxKept = 2;
  std::mutex mutex_;
  std::vector<std::pair<int32_t, std::vector<Level>>> kept_;
};

/// Allocates a level's arrays, zeroed, unless they exist.
void Smoother::make_level(size_t number) {
  const auto fit = [&](Level& level) {
    level.loose.resize(static_cast<size_t>(band_count(grid_.levels[number])));
    level.reassigned_joins.resize(grid_.levels[number].reassigned.size());
  };
  if (number < levels_.size()) {
    fit(levels_[number]);
    return;
  }
  Level& level = levels_.emplace_back();
  fit(level);
  const auto size = static_cast<ptrdiff_t>(grid_.levels[number].size);
  level.margin = size + kMargin;
  const auto count = static_cast<size_t>(size * size + 2 * level.margin);
  for (base::ZeroedArray<float>* values :
       {&level.height, &level.next, &level.right, &level.above, &level.inverse_weight}) {
    *values = base::ZeroedArray<float>(count);
  }
  if (number > 0) level.before = base::ZeroedArray<float>(count);
  level.run_row.assign(static_cast<size_t>(size) + 1, 0);
}

int32_t Smoother::band_count(const SmoothingLevel& grid) const {
  return grid.size <= kSmallLevel ? 1 : threads_;
}

void Smoother::for_each_row_band(
    const SmoothingLevel& grid,
    const std::function<void(size_t band, int32_t first, int32_t last)>& work) const {
  base::parallel_for(band_count(grid), [&](size_t part, size_t parts) {
    const auto rows = static_cast<size_t>(grid.size);
    work(part, static_cast<int32_t>(rows * part / parts),
         static_cast<int32_t>(rows * (part + 1) / parts));
  });
}

void Smoother::for_each_run(size_t number, const std::function<void(Run run)>& work) const {
  const Level& level = levels_[number];
  for_each_row_band(grid_.levels[number], [&](size_t, int32_t first, int32_t last) {
    for (int32_t r = level.run_row[first]; r < level.run_row[last]; ++r) work(level.runs[r]);
  });
}

/// Clears cells in runs of the previous map that are in no run of this one; the runs of this map
/// are overwritten.
void Smoother::clear_beyond_runs(size_t number, const std::vector<Run>& before) {
  Level& level = levels_[number];
  const auto clear = [&](int32_t begin, int32_t end) {
    if (begin >= end) return;
    for (base::ZeroedArray<float>* values :
         {&level.height, &level.next, &level.right, &level.above}) {
      std::fill(level.at(*values) + begin, level.at(*values) + end, 0.0f);
    }
  };
  size_t next = 0;
  for (const Run& old : before) {
    while (next < level.runs.size() && level.runs[next].end <= old.begin) ++next;
    int32_t at = old.begin;
    for (size_t r = next; r < level.runs.size() && level.runs[r].begin < old.end; ++r) {
      clear(at, level.runs[r].begin);
      at = level.runs[r].end;
    }
    clear(at, old.end);
  }
}

/// `is_filled(cell, count)`: whether any of the cells holds snow.
template <typename IsFilled, typename Runs>
static void find_level_runs(int32_t size, const IsFilled& is_filled, Runs& runs,
                            std::vector<int32_t>& run_row) {
  for (int32_t y = 0; y < size; ++y) {
    bool in_run = false;
    for (int32_t x = 0; x < size; x += kBlock) {
      const int32_t count = std::min(kBlock, size - x);
      const int32_t cell = y * size + x;
      const bool filled = is_filled(cell, count);
      if (filled && in_run) runs.back().end = cell + count;
      if (filled && !in_run) runs.push_back({cell, cell + count});
      in_run = filled;
    }
    run_row[static_cast<size_t>(y) + 1] = static_cast<int32_t>(runs.size());
  }
}

void Smoother::find_runs(const std::vector<float>& map) {
  const std::vector<Run> before = std::exchange(levels_[0].runs, {});
  find_level_runs(
      grid_.levels[0].size,
      [&](int32_t cell, int32_t count) { return holds_anything(map.data() + cell, count); },
      levels_[0].runs, levels_[0].run_row);
  clear_beyond_runs(0, before);
}

void Smoother::load(const std::vector<float>& map) {
  Level& level = levels_[0];
  for_each_run(0, [&](Run run) {
    load_run(map.data(), grid_.inverse_area.data(), level.at(level.height),
             level.at(level.inverse_weight), run.begin, run.end);
  });
}

/// Fills the next level with the mean heights of its blocks.
void Smoother::restrict_to(size_t number) {
  const Level& fine = levels_[number - 1];
  const SmoothingLevel& fine_grid = grid_.levels[number - 1];
  const SmoothingLevel& grid = grid_.levels[number];
  Level& level = levels_[number];
  const float* const height = fine.height.data() + fine.margin;
  const float* const inverse = fine.inverse_weight.data() + fine.margin;

  // Filled blocks of cells: those above the runs, and those that reassigned cells join.
  const int32_t blocks = (grid.size + kBlock - 1) / kBlock;
  std::vector<uint8_t> filled(static_cast<size_t>(blocks) * grid.size, 0);
  const auto mark = [&](int32_t cell) {
    filled[static_cast<size_t>(cell / grid.size * blocks + cell % grid.size / kBlock)] = 1;
  };
  for (const Run& run : fine.runs) {
    const int32_t y = run.begin / fine_grid.size / 2;
    if (y >= grid.size) continue;
    const int32_t last = std::min((run.end - 1) % fine_grid.size / 2, grid.size - 1);
    for (int32_t x = run.begin % fine_grid.size / 2; x <= last; x += kBlock / 2) {
      mark(y * grid.size + x);
    }
    mark(y * grid.size + last);
  }
  for (const SmoothingLevel::Reassigned& one : fine_grid.reassigned) {
    if (height[one.cell] != 0.0f) mark(one.parent);
  }
  const std::vector<Run> old_runs = std::exchange(level.runs, {});
  find_level_runs(
      grid.size,
      [&](int32_t cell, int32_t) {
        return filled[static_cast<size_t>(cell / grid.size * blocks + cell % grid.size / kBlock)] !=
               0;
      },
      level.runs, level.run_row);
  clear_beyond_runs(number, old_runs);

  for_each_run(number, [&](Run run) {
    const int32_t child = run.begin / grid.size * 2 * fine_grid.size + run.begin % grid.size * 2;
    restrict_run(height + child, height + child + fine_grid.size,
                 block_rows(fine_grid, inverse, child), level.at(level.height) + run.begin,
                 level.at(level.inverse_weight) + run.begin, run.end - run.begin);
  });
  for (size_t s = 0; s < fine_grid.reassigned.size(); ++s) {
    const auto [cell, parent] = fine_grid.reassigned[s];
    float& mean = level.at(level.height)[parent];
    float& weight = level.at(level.inverse_weight)[parent];
    const bool joins = height[cell] != 0.0f && (weight == 0.0f || is_open(height[cell], mean));
    levels_[number - 1].reassigned_joins[s] = joins ? 1 : 0;
    if (!joins) continue;
    const float own = 1.0f / inverse[cell];
    const float others = weight == 0.0f ? 0.0f : 1.0f / weight;
    mean = (mean * others + height[cell] * own) / (others + own);
    weight = 1.0f / (others + own);
  }
  for (const Run& run : level.runs) {
    std::copy(level.at(level.height) + run.begin, level.at(level.height) + run.end,
              level.at(level.before) + run.begin);
  }
}

/// Applies the change of each block's mean to its cells, in proportion, so that none falls below 0.
void Smoother::prolong_from(size_t number) {
  Level& fine = levels_[number - 1];
  const SmoothingLevel& fine_grid = grid_.levels[number - 1];
  const SmoothingLevel& grid = grid_.levels[number];
  Level& level = levels_[number];
  float* const height = fine.at(fine.height);
  const float* const now = level.at(level.height);
  const float* const before = level.at(level.before);
  for_each_run(number, [&](Run run) {
    const int32_t child = run.begin / grid.size * 2 * fine_grid.size + run.begin % grid.size * 2;
    prolong_run(height + child, height + child + fine_grid.size,
                block_rows(fine_grid, fine.at(fine.inverse_weight), child), before + run.begin,
                now + run.begin,
                {grid.to_right() + run.begin, grid.upwards() + run.begin, least_variance_,
                 done_below_[number]},
                run.end - run.begin);
  });
  for (size_t s = 0; s < fine_grid.reassigned.size(); ++s) {
    if (fine.reassigned_joins[s] == 0) continue;
    const auto [cell, parent] = fine_grid.reassigned[s];
    height[cell] =
        changed(height[cell], before[parent], now[parent], damping_of_block(number, parent));
  }
}

float Smoother::damping_of_block(size_t number, int32_t block) const {
  const Level& level = levels_[number];
  const SmoothingLevel& grid = grid_.levels[number];
  const float closeness = from_half(std::max(grid.to_right()[block], grid.upwards()[block]));
  return damping(level.at(level.before)[block], closeness, least_variance_, done_below_[number]);
}

void Smoother::cycle(size_t number, float variance) {
  const size_t next = number + 1;
  const float left = variance * std::pow(0.25f, static_cast<float>(next));
  if (next >= grid_.levels.size() || left <= done_below_[next]) {
    stages(number, kStagesUp + kStagesDown);
    return;
  }
  stages(number, kStagesUp);
  make_level(next);
  restrict_to(next);
  open_loose_links(next);
  conduct(next);
  cycle(next, variance);
  prolong_from(next);
  stages(number, kStagesDown);
}

void Smoother::store(std::vector<float>& map) {
  Level& level = levels_[0];
  for_each_run(0, [&](Run run) {
    store_run(level.at(level.height), grid_.inverse_area.data(), map.data(), run.begin, run.end);
  });
}

void Smoother::run(std::vector<float>& map) {
  const int32_t size = grid_.levels[0].size;
  levels_ = Workspace::shared().acquire(size);
  make_level(0);
  find_runs(map);
  if (!levels_[0].runs.empty() && least_variance_ > 0.0f) {
    load(map);
    open_loose_links(0);
    cycle(0, conduct(0));
    store(map);
  }
  Workspace::shared().release(size, std::move(levels_));
  levels_.clear();
}

}  // namespace snowbough::snow
