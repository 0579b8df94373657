#include "snow/movement/repose/rooms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/simd.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/granular.h"
#include "snow/movement/repose/tiles_around.h"

namespace snowbough::snow {
namespace {

/// Rays from a texel begin this fraction of its half width beside its surface, so that they do not
/// graze the edges of a wall on which its middle lies, and pass surfaces within this fraction.
constexpr float kOwnSurface = 0.02f;

/// Where the ray upwards from a texel's middle begins, if the vertices are at `positions`.
glm::dvec3 beside_surface(const ReposeGround& ground, int32_t texel, double away,
                          const std::vector<glm::vec3>& positions) {
  const auto i = static_cast<size_t>(texel);
  const ReposeLinks::Point at{ground.table().triangle[i], ground.table().barycentric[i]};
  const int32_t* const corners =
      &ground.object->description.topology.triangles[3 * static_cast<size_t>(at.triangle)];
  const auto corner = [&](int k) { return glm::dvec3(positions[static_cast<size_t>(corners[k])]); };
  const glm::dvec3 normal = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
  const double size = glm::length(normal);
  const glm::dvec2 aside = size > 0.0 ? glm::dvec2(normal) * (away / size) : glm::dvec2(0.0);
  return point_on(ground, at, positions) + glm::dvec3(aside, 0.0);
}

/// The vertical distance from a texel to the first surface above, 0 within a body.
float room_above(ReposeGround& ground, const SceneRays& rays, int32_t texel, size_t cell,
                 ReposeTile& tile) {
  const float reach = 0.5f * std::sqrt(tile.ground.area[cell]);
  const double least = kOwnSurface * reach;
  const glm::dvec3 up(0.0, 0.0, 1.0);
  const auto room_below = [&](const RayHit& above) {
    const auto room = static_cast<float>(above.distance);
    // Nothing flows into a slit.
    return above.is_inside(false) || room < reach ? 0.0f : room;
  };
  const bool is_rigid = ground.pose.is_rigid();
  const float others = room_below(rays.first_along(
      beside_surface(ground, texel, least, ground.object->positions), up, least,
      std::numeric_limits<double>::infinity(), is_rigid ? ground.object : nullptr));
  if (!is_rigid) return others;
  float& own = tile.ground.own_room[cell];
  if (own < 0.0f) {
    const glm::dvec3 from = beside_surface(ground, texel, least, ground.pose.positions());
    const auto hit =
        ground.own_rays.first_along(from, up, least, std::numeric_limits<double>::infinity());
    own = room_below(ground.own_rays.hit_at(hit, 0, from, up));
  }
  return std::min(own, others);
}

/// Planes of a block's cells and one cell on every side, whose rows are loaded on demand.
class Ring {
 public:
  explicit Ring(const TilesAround& around) : around_(around) {}

  /// The cells of a row beside which snow is steeper than `slope` (a tangent), so that it may flow
  /// onto them: one bit per column.
  uint32_t below_snow(int32_t row, float slope);

 private:
  static constexpr int32_t kSide = kReposeBlock + 2;
  using Plane = std::array<float, kSide * kSide>;

  void load(int32_t row) {
    if ((loaded_ >> (row + 1) & 1) != 0) return;
    loaded_ |= uint64_t{1} << static_cast<uint32_t>(row + 1);
    const int32_t dy = row < 0 ? -1 : row / kReposeBlock;
    const auto inner = static_cast<size_t>((row & (kReposeBlock - 1)) * kReposeBlock);
    const auto first = static_cast<size_t>((row + 1) * kSide);
    copy(around_.at(-1, dy), inner + kReposeBlock - 1, first, 1);
    copy(around_.at(0, dy), inner, first + 1, kReposeBlock);
    copy(around_.at(1, dy), inner, first + 1 + kReposeBlock, 1);
  }
  void copy(const ReposeTile* tile, size_t from, size_t to, size_t count) {
    if (tile == nullptr) {
      for (Plane* plane : {&x_, &y_, &top_, &gives_}) std::fill_n(plane->begin() + to, count, 0.0f);
      return;
    }
    std::copy_n(tile->ground.x.begin() + from, count, x_.begin() + to);
    std::copy_n(tile->ground.y.begin() + from, count, y_.begin() + to);
    std::copy_n(tile->snow.top.begin() + from, count, top_.begin() + to);
    std::copy_n(tile->snow.gives.begin() + from, count, gives_.begin() + to);
  }

  const TilesAround& around_;
  uint64_t loaded_ = 0;
  Plane x_, y_, top_, gives_;
};

/// Marks the cells of a row beside which snow is higher than `slope` allows; `step`: to the
/// neighbour. Planes begin at the row's first cell.
SNOWBOUGH_WIDE void mark_below(const float* __restrict x, const float* __restrict y,
                               const float* __restrict top, const float* __restrict gives,
                               int32_t step, float slope, uint32_t* __restrict marks) {
  const float square = slope * slope;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const float way_x = x[i + step] - x[i];
    const float way_y = y[i + step] - y[i];
    const float over = top[i + step] - top[i];
    const bool is_steep = (over > 0.0f) & (over * over > square * (way_x * way_x + way_y * way_y));
    marks[i] |= (is_steep & (gives[i + step] >= 1.0f)) ? 1u : 0u;
  }
}

SNOWBOUGH_WIDE uint32_t bits_of(const uint32_t* __restrict marks) {
  uint32_t bits = 0;
  for (uint32_t i = 0; i < kReposeBlock; ++i) bits |= marks[i] << i;
  return bits;
}

uint32_t Ring::below_snow(int32_t row, float slope) {
  for (const int32_t own : {row - 1, row, row + 1}) load(own);
  const auto first = static_cast<size_t>((row + 1) * kSide + 1);
  std::array<uint32_t, kReposeBlock> marks{};
  for (const int32_t step : {1, -1, kSide, -kSide, kSide + 1, kSide - 1, -kSide + 1, -kSide - 1}) {
    mark_below(&x_[first], &y_[first], &top_[first], &gives_[first], step, slope, marks.data());
  }
  return bits_of(marks.data());
}

/// Whether the room above any texel of a row is unknown or full.
SNOWBOUGH_WIDE bool may_be_full(const float* __restrict room, const float* __restrict top,
                                const float* __restrict z, const uint8_t* __restrict forward) {
  int32_t any = 0;
  for (int32_t i = 0; i < kReposeBlock; ++i) {
    const bool is_texel = (forward[i] & kHasTexel) != 0;
    any |= (is_texel & ((room[i] < 0.0f) | (top[i] - z[i] >= room[i]))) ? 1 : 0;
  }
  return any != 0;
}

/// Whether no snow lies on a block or beside it.
bool is_bare(const TilesAround& around) {
  for (const auto& row : around.tiles) {
    for (const ReposeTile* tile : row) {
      if (tile != nullptr && !tile->snow.is_bare) return false;
    }
  }
  return true;
}

/// Marks the full cells, one bit per column, by row.
ChangedCells set_full(ReposeTile& tile, const std::array<uint32_t, kReposeBlock>& full,
                      bool any_full) {
  ChangedCells changed;
  if (!any_full && !tile.snow.any_full) return changed;
  tile.snow.any_full = any_full;
  for (int32_t cell = 0; cell < kTileCells; ++cell) {
    const int32_t row = cell / kReposeBlock;
    const int32_t column = cell % kReposeBlock;
    const auto own = static_cast<size_t>(cell);
    const bool is_full =
        ((full[static_cast<size_t>(row)] >> static_cast<uint32_t>(column)) & 1) != 0;
    if (is_full == tile.snow.is_full(own)) continue;
    tile.snow.kind[own] ^= kFull;
    changed.add(column, row);
    changed.is_at_seam = changed.is_at_seam || (tile.ground.forward[own] & kAtSeam) != 0;
  }
  return changed;
}

}  // namespace

ChangedCells fill_rooms(ReposeGround& ground, const SceneRays& rays, const ReposeLimits& limits,
                        const ReposeTiles& tiles, int32_t block) {
  ReposeTile& tile = *tiles[static_cast<size_t>(block)];
  const TilesAround around(tiles, ground.links->blocks_a_side, block);
  std::array<uint32_t, kReposeBlock> full{};
  bool any_full = false;
  if (!is_bare(around)) {
    const float slope = (limits.is_granular ? kGranularSure : shared::kEven) * limits.slope;
    std::array<uint32_t, kReposeBlock> wanted{};
    uint32_t rows = 0;
    Ring ring(around);
    for (int32_t row = 0; row < kReposeBlock; ++row) {
      const auto first = static_cast<size_t>(row * kReposeBlock);
      if (!may_be_full(&tile.ground.room[first], &tile.snow.top[first], &tile.ground.z[first],
                       &tile.ground.forward[first])) {
        continue;
      }
      wanted[static_cast<size_t>(row)] = ring.below_snow(row, slope);
      if (wanted[static_cast<size_t>(row)] != 0) rows |= 1u << static_cast<uint32_t>(row);
    }
    const auto find_room = [&](int32_t texel, size_t cell) {
      float& room = tile.ground.room[cell];
      const auto column = static_cast<uint32_t>(cell % kReposeBlock);
      if (((wanted[cell / kReposeBlock] >> column) & 1) == 0) return;
      if (room < 0.0f) room = room_above(ground, rays, texel, cell, tile);
      const float rise = tile.snow.top[cell] - tile.ground.z[cell];
      if (rise >= room && !tile.snow.is_wall(cell)) {
        full[cell / kReposeBlock] |= 1u << column;
        any_full = true;
      }
    };
    if (rows != 0) ground.links->for_texels(block, ground.table().texel, find_room, rows);
  }
  return set_full(tile, full, any_full);
}

ChangedCells clear_rooms(ReposeTile& tile) {
  return set_full(tile, {}, false);
}

}  // namespace snowbough::snow
