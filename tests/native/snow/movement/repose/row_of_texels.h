#pragma once

// Tiles with a few texels, for tests of repose.
#include <memory>
#include <numeric>
#include <vector>

#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/tile.h"

namespace snowbough::snow {

inline constexpr float kUnit = 1e-9f;

/// A level row of `count` texels of 1 cm in a tile, each linked with the next; 0.1 m up.
inline ReposeTiles row_of(int count) {
  ReposeTiles tiles(1);
  tiles[0] = std::make_unique<ReposeTile>();
  ReposeTile& tile = *tiles[0];
  tile.begin_pose();
  for (int i = 0; i < count; ++i) {
    const auto cell = static_cast<size_t>(i);
    tile.ground.x[cell] = 0.01f * static_cast<float>(i);
    tile.ground.z[cell] = 0.1f;
    tile.ground.normal_z[cell] = tile.ground.up[cell] = 1.0f;
    tile.ground.area[cell] = 1e-4f;
    tile.ground.forward[cell] = i + 1 < count ? 1 : 0;
  }
  return tiles;
}

inline void cover(ReposeTiles& tiles, const std::vector<float>& heights) {
  for (size_t i = 0; i < heights.size(); ++i) tiles[0]->cover(i, heights[i], kUnit);
  tiles[0]->begin_step();
  set_up_tile_links(tiles, 0, 1, {1.0f / shared::kEven, 0.0f});
}

/// Two tiles side by side with a level row of 64 texels, covered by `heights`, whose step has
/// begun.
inline ReposeTiles two_tiles(const std::vector<float>& heights) {
  ReposeTiles tiles(4);
  for (size_t t : {0, 1}) tiles[t] = std::move(row_of(32)[0]);
  for (size_t i = 0; i < 32; ++i) tiles[1]->ground.x[i] += 0.32f;
  tiles[0]->ground.forward[31] = 1;
  for (size_t i = 0; i < heights.size(); ++i) tiles[i / 32]->cover(i % 32, heights[i], kUnit);
  for (size_t t : {0, 1}) tiles[t]->begin_step();
  for (const int32_t block : {0, 1})
    set_up_tile_links(tiles, block, 2, {1.0f / shared::kEven, 0.0f});
  return tiles;
}

inline double all_moved(const ReposeTile& tile) {
  return std::accumulate(tile.snow.moved.begin(), tile.snow.moved.end(), 0.0);
}

/// A level row whose first texel has an open edge half a texel away.
inline std::vector<OutletLink> outlet_links_of(const ReposeTiles& tiles) {
  return {{.top = 0.1f, .limit = 0.005f, .rate = shared::link_rate(tiles[0]->stiffness(0), 0.0f)}};
}

}  // namespace snowbough::snow
