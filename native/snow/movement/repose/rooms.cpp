#include "snow/movement/repose/rooms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

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
  const auto room_below = [&](const SurfaceHit& above) {
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
    own = room_below(ground.own_rays.surface_at(hit, 0, from, up));
  }
  return std::min(own, others);
}

}  // namespace

bool fill_rooms(ReposeGround& ground, const SceneRays& rays, const ReposeLimits& limits,
                const ReposeTiles& tiles, int32_t block) {
  ReposeTile& tile = *tiles[static_cast<size_t>(block)];
  const std::array<uint32_t, kReposeBlock> wanted =
      cells_below_snow(TilesAround(tiles, ground.links->blocks_a_side, block),
                       (limits.is_granular ? kGranularSure : shared::kEven) * limits.slope);
  uint32_t rows = 0;
  for (uint32_t row = 0; row < kReposeBlock; ++row) rows |= (wanted[row] != 0 ? 1u : 0u) << row;
  if (rows == 0 && !tile.snow.any_full) return false;
  std::array<uint32_t, kReposeBlock> full{};
  const auto find_room = [&](int32_t texel, size_t cell) {
    float& room = tile.ground.room[cell];
    const auto column = static_cast<uint32_t>(cell % kReposeBlock);
    if (((wanted[cell / kReposeBlock] >> column) & 1) == 0) return;
    if (room < 0.0f) room = room_above(ground, rays, texel, cell, tile);
    const float rise = tile.snow.top[cell] - tile.ground.z[cell];
    if (rise >= room && !tile.snow.is_wall(cell)) {
      full[cell / kReposeBlock] |= 1u << column;
    }
  };
  ground.links->for_texels(block, ground.table().texel, find_room, rows);
  bool changes = false;
  tile.snow.any_full = false;
  for (size_t cell = 0; cell < size_t{kTileCells}; ++cell) {
    const bool is_full = ((full[cell / kReposeBlock] >> (cell % kReposeBlock)) & 1) != 0;
    tile.snow.any_full = tile.snow.any_full || is_full;
    if (is_full == tile.snow.is_full(cell)) continue;
    tile.snow.kind[cell] ^= kFull;
    changes = true;
  }
  return changes;
}

bool clear_rooms(ReposeTile& tile) {
  TileSnow& snow = tile.snow;
  if (!snow.any_full) return false;
  for (uint8_t& kind : snow.kind) kind &= static_cast<uint8_t>(~kFull);
  snow.any_full = false;
  return true;
}

}  // namespace snowbough::snow
