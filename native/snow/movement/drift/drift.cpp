#include "snow/movement/drift/drift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/parallel_for.h"
#include "base/simd.h"
#include "shaders/lib/texel_repose.h"

namespace snowbough::snow {
namespace {

/// Smallest edge of a cell in metres, doubled until it is so many texels wide and no side has more
/// than this many cells.
constexpr double kSmallestCell = 0.1;
constexpr double kTexelsInCell = 1.5;
constexpr int32_t kMaxCells = 512;
/// The wind reaches texels that lie at most this part of a cell below the highest surface, and as
/// much more on a slope.
constexpr float kLower = 0.2f;
constexpr float kLowerOnSlope = 1.5f;
/// Cells with less ground than this part of them take no snow. The ground on both sides of a fence
/// covers a quarter of its cells.
constexpr double kMinGround = 0.4;
/// Thinner snow is blown away, in metres.
constexpr float kBlownAway = 1e-6f;
/// The most texels side by side that move at once.
constexpr size_t kRowRun = 64;
constexpr float kNothing = -std::numeric_limits<float>::infinity();

bool is_shown(const SceneObject& object) {
  return (object.description.receive || object.description.occlude) && !object.hidden &&
         !object.positions.empty();
}

std::array<float, 4> weights_of(float x, float y) {
  return {(1.0f - x) * (1.0f - y), (1.0f - x) * y, x * (1.0f - y), x * y};
}

/// Sums of volumes, and of these times their parts of the way to the next row, to the next column,
/// and both.
using Sums = double __attribute__((vector_size(32)));

/// Adds the snow of texels; `packed`: by texel of the table, metres that stay; null: none.
SNOWBOUGH_WIDE void add_snow(const int32_t* place, const int32_t* texel, const float* area,
                             const float* x, const float* y, size_t count, const float* height,
                             const float* packed, Sums& all, Sums& stays) {
  for (size_t i = 0; i < count; ++i) {
    const auto part_x = static_cast<double>(x[i]), part_y = static_cast<double>(y[i]);
    const float own = std::abs(height[place[i]]);
    const Sums parts{1.0, part_y, part_x, part_x};
    const Sums again{1.0, 1.0, 1.0, part_y};
    all += static_cast<double>(own * area[i]) * parts * again;
    if (packed == nullptr) continue;
    stays += static_cast<double>(std::min(packed[texel[i]], own) * area[i]) * parts * again;
  }
}

/// What leaves and comes to a cell's texels by the moves of the four cells around: see Drift.
struct CellMoves {
  std::array<float, 4> comes, leaves;
};

/// The thickness of a run of texels after the wind.
SNOWBOUGH_WIDE void move_run(const CellMoves& moves, const float* __restrict up,
                             const float* __restrict x, const float* __restrict y, size_t count,
                             const float* __restrict packed, const float* __restrict height,
                             float* __restrict now) {
  for (size_t i = 0; i < count; ++i) {
    const float left = 1.0f - x[i];
    const float low = 1.0f - y[i];
    float comes = left * low * moves.comes[0];
    float leaves = left * low * moves.leaves[0];
    comes += left * y[i] * moves.comes[1];
    leaves += left * y[i] * moves.leaves[1];
    comes += x[i] * low * moves.comes[2];
    leaves += x[i] * low * moves.leaves[2];
    comes += x[i] * y[i] * moves.comes[3];
    leaves += x[i] * y[i] * moves.leaves[3];
    const float own = std::abs(height[i]);
    const float after = own + comes * std::abs(up[i]) - leaves * (own - std::min(packed[i], own));
    const float thick = after < kBlownAway ? 0.0f : after;
    const float side = (height[i] != 0.0f ? height[i] : up[i]) < 0.0f ? -1.0f : 1.0f;
    // No zero is negative.
    now[i] = side * thick + 0.0f;
  }
}

/// The four cells of a texel from the first one on.
std::array<size_t, 4> cells_of(size_t first, int32_t rows) {
  const auto next = static_cast<size_t>(rows);
  return {first, first + 1, first + next, first + next + 1};
}

}  // namespace

void Drift::lay_out(const std::vector<const SceneObject*>& objects) {
  objects_ = objects;
  is_known_ = false;
}

glm::dvec2 Drift::in_wind(const glm::vec3& point) const {
  const glm::dvec2 at(point);
  return {glm::dot(at, wind_), wind_.x * at.y - wind_.y * at.x};
}

/// By cell: the highest surface of all objects that block the wind.
std::vector<float> Drift::tops_of_objects(glm::ivec2 low) const {
  std::vector<float> tops(grid_.cells.size(), kNothing);
  for (const SceneObject* object : objects_) {
    if (!is_shown(*object) || !object->press.blocks_wind) continue;
    const std::vector<int32_t>& corners = object->description.topology.triangles;
    for (size_t t = 0; t + 2 < corners.size(); t += 3) {
      std::array<glm::dvec3, 3> corner;
      for (size_t k = 0; k < 3; ++k) {
        const glm::vec3& point = object->positions[static_cast<size_t>(corners[t + k])];
        corner[k] = {in_wind(point) / grid_.cell, static_cast<double>(point.z)};
      }
      const glm::dvec3 b = corner[1] - corner[0];
      const glm::dvec3 c = corner[2] - corner[0];
      const double longest = std::max(
          {glm::length(glm::dvec2(b)), glm::length(glm::dvec2(c)), glm::length(glm::dvec2(c - b))});
      // Points half a cell apart.
      const double count = std::ceil(std::min(2.0 * longest, 4.0 * kMaxCells)) + 1.0;
      for (double i = 0.0; i <= count; i += 1.0) {
        for (double j = 0.0; i + j <= count; j += 1.0) {
          const glm::dvec3 at = corner[0] + (i / count) * b + (j / count) * c;
          const glm::ivec2 cell = glm::ivec2(glm::floor(glm::dvec2(at))) - low;
          if (cell.x < 0 || cell.y < 0 || cell.x >= grid_.columns || cell.y >= grid_.rows) continue;
          float& top = tops[static_cast<size_t>(cell.x) * static_cast<size_t>(grid_.rows) +
                            static_cast<size_t>(cell.y)];
          top = std::max(top, static_cast<float>(at.z));
        }
      }
    }
  }
  return tops;
}

/// Finds the texels of a receiver that the wind reaches, and adds their ground to the cells.
void Drift::reach(const Receiver& receiver, glm::ivec2 low, const std::vector<float>& tops) {
  const SceneObject& object = *objects_[receiver.map->object];
  const TexelTable& table = *object.table;
  const BareTexels& bare = receiver.repose->bare();
  const std::vector<int32_t>& corners = object.description.topology.triangles;
  // Leaves in a wind that passes them lie above all that blocks it.
  const size_t count = object.press.blocks_wind ? table.texel.size() : 0;
  std::vector<int32_t> first(count, -1);
  std::vector<float> height(count, 0.0f);
  std::vector<glm::vec2> part(count);
  const auto edge = static_cast<float>(grid_.cell);
  base::for_each_item(count, 4096, [&](size_t i) {
    const auto triangle = static_cast<size_t>(table.triangle[i]);
    const float up = bare.up[i];
    const bool is_back = up < 0.0f;
    if (shared::is_wall(std::abs(up)) || !(bare.area[i] > 0.0f)) return;
    if (is_back && (object.two_sided.empty() || object.two_sided[triangle] == 0)) return;
    const auto corner = [&](size_t k) {
      return glm::dvec3(object.positions[static_cast<size_t>(corners[3 * triangle + k])]);
    };
    const glm::dvec2 weight(table.barycentric[i]);
    const glm::vec3 point(corner(0) + weight.x * (corner(1) - corner(0)) +
                          weight.y * (corner(2) - corner(0)));
    const glm::dvec2 at = in_wind(point) / grid_.cell;
    const glm::ivec2 own = glm::ivec2(glm::floor(at)) - low;
    const float top = tops[static_cast<size_t>(own.x) * static_cast<size_t>(grid_.rows) +
                           static_cast<size_t>(own.y)];
    const float steep = std::sqrt(std::max(1.0f - up * up, 0.0f)) / std::abs(up);
    if (point.z < top - edge * (kLower + kLowerOnSlope * steep)) return;
    const glm::dvec2 corner_at = glm::floor(at - 0.5);
    const glm::ivec2 base = glm::ivec2(corner_at) - low;
    first[i] = base.x * grid_.rows + base.y;
    part[i] = glm::vec2(at - 0.5 - corner_at);
    height[i] = point.z;
  });
  Reached& own = reached_.emplace_back();
  own.object = receiver.map->object;
  own.begin.assign(grid_.cells.size() + 1, 0);
  for (const int32_t cell : first) {
    if (cell >= 0) ++own.begin[static_cast<size_t>(cell) + 1];
  }
  for (size_t cell = 0; cell < grid_.cells.size(); ++cell) own.begin[cell + 1] += own.begin[cell];
  const auto reached = static_cast<size_t>(own.begin.back());
  for (auto* plane : {&own.texel, &own.place}) plane->resize(reached);
  for (auto* plane : {&own.area, &own.up, &own.x, &own.y}) plane->resize(reached);
  std::vector<int32_t> next = own.begin;
  for (size_t i = 0; i < count; ++i) {
    if (first[i] < 0) continue;
    const auto at = static_cast<size_t>(next[static_cast<size_t>(first[i])]++);
    own.texel[at] = static_cast<int32_t>(i);
    own.place[at] = table.texel[i];
    own.area[at] = bare.area[i];
    own.up[at] = bare.up[i];
    own.x[at] = part[i].x;
    own.y[at] = part[i].y;
    const double ground = static_cast<double>(bare.area[i] * std::abs(bare.up[i]));
    const std::array<float, 4> weight = weights_of(part[i].x, part[i].y);
    const std::array<size_t, 4> cells = cells_of(static_cast<size_t>(first[i]), grid_.rows);
    for (size_t k = 0; k < 4; ++k) {
      const double share = static_cast<double>(weight[k]) * ground;
      grid_.cells[cells[k]].ground += share;
      // The mean height, divided below.
      grid_.cells[cells[k]].top += share * static_cast<double>(height[i]);
    }
  }
}

void Drift::find_ground(const DriftSettings& settings, const std::vector<Receiver>& receivers) {
  is_known_ = true;
  wind_ = settings.wind;
  reached_.clear();
  glm::dvec2 low(std::numeric_limits<double>::infinity());
  glm::dvec2 high = -low;
  double texel = 0.0;
  for (const Receiver& receiver : receivers) {
    const BareTexels& bare = receiver.repose->bare();
    const auto count = static_cast<double>(std::max<size_t>(bare.area.size(), 1));
    texel = std::max(texel, std::sqrt(bare.whole_area / count));
    for (const glm::vec3& point : objects_[receiver.map->object]->positions) {
      low = glm::min(low, in_wind(point));
      high = glm::max(high, in_wind(point));
    }
  }
  grid_ = {};
  if (!(low.x < high.x) || !(low.y < high.y)) return;
  grid_.cell = kSmallestCell;
  const double largest = std::max(high.x - low.x, high.y - low.y);
  while (largest > kMaxCells * grid_.cell || kTexelsInCell * texel > grid_.cell) grid_.cell *= 2.0;
  // Cells lie fixed in the world, with one more around all.
  const glm::ivec2 first = glm::ivec2(glm::floor(low / grid_.cell)) - 1;
  const glm::ivec2 size = glm::ivec2(glm::floor(high / grid_.cell)) + 2 - first;
  grid_.columns = size.x;
  grid_.rows = size.y;
  grid_.cells.resize(static_cast<size_t>(size.x) * static_cast<size_t>(size.y));
  const std::vector<float> tops = tops_of_objects(first);
  for (const Receiver& receiver : receivers) reach(receiver, first, tops);
  const double least = kMinGround * grid_.cell * grid_.cell;
  for (size_t i = 0; i < grid_.cells.size(); ++i) {
    DriftCell& cell = grid_.cells[i];
    if (cell.ground >= least) {
      cell.top /= cell.ground;
    } else {
      cell = {};
      cell.is_obstacle = tops[i] > kNothing;
      if (cell.is_obstacle) cell.top = static_cast<double>(tops[i]);
    }
  }
}

/// Calls visit(column) so that the four cells of no two texels are visited at once.
template <typename Visit>
void Drift::for_columns(const Visit& visit) const {
  for (int32_t odd = 0; odd < 2; ++odd) {
    base::for_each_item(static_cast<size_t>((grid_.columns - odd) / 2), 8,
                        [&](size_t i) { visit(2 * static_cast<int32_t>(i) + odd); });
  }
}

/// Adds a map's loose snow to the cells.
void Drift::find_snow(const Receiver& receiver, const Reached& reached) {
  const std::vector<float>& heights = *receiver.map->height;
  for_columns([&](int32_t column) {
    const auto begin = static_cast<size_t>(column) * static_cast<size_t>(grid_.rows);
    for (size_t first = begin; first + 1 < begin + static_cast<size_t>(grid_.rows); ++first) {
      Sums all{}, packed{};
      const auto at = static_cast<size_t>(reached.begin[first]);
      add_snow(&reached.place[at], &reached.texel[at], &reached.area[at], &reached.x[at],
               &reached.y[at], static_cast<size_t>(reached.begin[first + 1]) - at, heights.data(),
               receiver.packed != nullptr ? receiver.packed->data() : nullptr, all, packed);
      const auto of_cell = [](const Sums& sums, size_t k) {
        const double both = sums[3];
        return k == 0   ? std::max(sums[0] - sums[1] - sums[2] + both, 0.0)
               : k == 1 ? std::max(sums[1] - both, 0.0)
               : k == 2 ? std::max(sums[2] - both, 0.0)
                        : both;
      };
      const std::array<size_t, 4> cells = cells_of(first, grid_.rows);
      for (size_t k = 0; k < 4; ++k) {
        DriftCell& cell = grid_.cells[cells[k]];
        if (!(cell.ground > 0.0)) continue;
        cell.loose += std::max(of_cell(all, k) - of_cell(packed, k), 0.0);
        cell.top += of_cell(all, k) / cell.ground;
      }
    }
  });
}

void Drift::move_snow(const Receiver& receiver, const Reached& reached) const {
  std::vector<double> lost(static_cast<size_t>(grid_.columns), 0.0);
  std::vector<uint8_t> changes(lost.size(), 0);
  for_columns([&](int32_t column) {
    const auto begin = static_cast<size_t>(column) * static_cast<size_t>(grid_.rows);
    for (size_t first = begin; first + 1 < begin + static_cast<size_t>(grid_.rows); ++first) {
      const std::array<size_t, 4> cells = cells_of(first, grid_.rows);
      if (std::all_of(cells.begin(), cells.end(),
                      [&](size_t cell) { return moves_[cell] == glm::vec2(0.0f); })) {
        continue;
      }
      CellMoves moves;
      for (size_t k = 0; k < 4; ++k) {
        moves.comes[k] = moves_[cells[k]].x;
        moves.leaves[k] = moves_[cells[k]].y;
      }
      const auto end = static_cast<size_t>(reached.begin[first + 1]);
      for (auto at = static_cast<size_t>(reached.begin[first]); at < end;) {
        // Texels side by side.
        const auto place = static_cast<size_t>(reached.place[at]);
        size_t count = 1;
        while (count < kRowRun && at + count < end &&
               static_cast<size_t>(reached.place[at + count]) == place + count) {
          ++count;
        }
        std::array<float, kRowRun> packed{}, now;
        for (size_t i = 0; receiver.packed != nullptr && i < count; ++i) {
          packed[i] = (*receiver.packed)[static_cast<size_t>(reached.texel[at + i])];
        }
        float* const height = &(*receiver.map->height)[place];
        move_run(moves, &reached.up[at], &reached.x[at], &reached.y[at], count, packed.data(),
                 height, now.data());
        for (size_t i = 0; i < count; ++i) {
          if (std::abs(now[i]) == std::abs(height[i])) continue;
          lost[static_cast<size_t>(column)] +=
              (static_cast<double>(std::abs(height[i])) - static_cast<double>(std::abs(now[i]))) *
              static_cast<double>(reached.area[at + i]);
          changes[static_cast<size_t>(column)] = 1;
          height[i] = now[i];
        }
        at += count;
      }
    }
  });
  for (size_t column = 0; column < lost.size(); ++column) {
    receiver.map->drifted += lost[column];
    receiver.map->has_changed = receiver.map->has_changed || changes[column] != 0;
  }
}

void Drift::blow(const DriftSettings& settings, const std::vector<Receiver>& receivers) {
  if (!settings.is_on()) return;
  if (!is_known_ || wind_ != settings.wind) find_ground(settings, receivers);
  if (grid_.cells.empty()) return;
  const std::vector<DriftCell> ground = grid_.cells;
  for (size_t i = 0; i < receivers.size(); ++i) find_snow(receivers[i], reached_[i]);
  const std::vector<DriftCell> before = grid_.cells;
  transport(grid_, settings.flux);
  moves_.assign(ground.size(), glm::vec2(0.0f));
  for (size_t i = 0; i < ground.size(); ++i) {
    const double change = grid_.cells[i].change;
    if (change > 0.0) moves_[i].x = static_cast<float>(change / before[i].ground);
    if (change < 0.0) moves_[i].y = static_cast<float>(-change / before[i].loose);
  }
  grid_.cells = ground;
  for (size_t i = 0; i < receivers.size(); ++i) move_snow(receivers[i], reached_[i]);
}

}  // namespace snowbough::snow
