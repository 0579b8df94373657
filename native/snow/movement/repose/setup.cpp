// Repose: choosing blocks and setting up their links.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/repose.h"
#include "snow/movement/repose/rooms.h"
#include "snow/movement/repose/tiles_around.h"

namespace snowbough::snow {
/// Evaluates the surface, if it has changed for repose.
void Repose::update_pose() {
  if (!update_ground(ground_, choice_.limits.cohesion > 0.0f)) return;
  const size_t blocks = ground_.links->block_count();
  choice_.slack.assign(blocks, std::nullopt);
  if (blocks_.tiles.size() != blocks) {
    blocks_.tiles.resize(blocks);
    blocks_.stored.resize(blocks);
    blocks_.outlet_links.resize(blocks);
    blocks_.flows.links.resize(ground_.links->across.size());
    blocks_.flows.is_noted.assign(blocks, 0);
    blocks_.was_chosen.assign(blocks, 0);
  }
  for (const std::unique_ptr<ReposeTile>& tile : blocks_.stored) {
    if (tile != nullptr) tile->ground.has_pose = false;
  }
}

/// Releases the tiles, and treats all blocks as new in the next step.
void Repose::forget_tiles() {
  for (std::unique_ptr<ReposeTile>& tile : blocks_.stored) tile.reset();
  blocks_.was_chosen.assign(blocks_.was_chosen.size(), 0);
}

/// Returns false if no snow lies on the map.
bool Repose::begin_choice(const std::vector<float>& height, const ReposeLimits& limits) {
  choice_.is_partial = false;
  choice_.chosen.clear();
  choice_.blades.clear();
  if (limits != choice_.limits) {
    // Curvatures are only needed with cohesion.
    if ((limits.cohesion > 0.0f) != (choice_.limits.cohesion > 0.0f)) {
      ground_.has_pose = false;
      ground_.pose = {};
    }
    choice_.limits = limits;
    choice_.slack.assign(choice_.slack.size(), std::nullopt);
    // Treat all blocks as new.
    blocks_.was_chosen.assign(blocks_.was_chosen.size(), 0);
  }
  if (!ground_.has_pose) {
    const bool is_bare = std::all_of(height.begin(), height.end(), [](float h) { return h == 0; });
    if (is_bare) return false;
    update_pose();
  }
  choice_.highest.resize(choice_.slack.size());
  return true;
}

size_t Repose::choose_blocks(const std::vector<float>& height, const ReposeLimits& limits,
                             const std::vector<int32_t>& blades, bool only_there,
                             const std::vector<uint8_t>& within) {
  const bool has_snow = begin_choice(height, limits);
  choice_.within = within;
  if (!has_snow || (only_there && blades.empty())) return 0;
  snow::choose_blocks(ground_, height, blades, only_there, choice_);
  if (choice_.chosen.empty()) forget_tiles();
  return choice_.chosen.size();
}

/// Provides the tiles of the chosen blocks, reusing those of the last run; marks the blocks that
/// were added or removed.
void Repose::reuse_tiles(Marks& changes) {
  if (choice_.is_partial) {
    blocks_.tiles.swap(blocks_.stored);
    for (const int32_t block : choice_.chosen) {
      std::unique_ptr<ReposeTile>& tile = blocks_.tiles[static_cast<size_t>(block)];
      if (tile != nullptr) continue;
      tile = std::make_unique_for_overwrite<ReposeTile>();
      blocks_.was_chosen[static_cast<size_t>(block)] = changes[static_cast<size_t>(block)] = 1;
    }
    return;
  }
  Marks is_chosen(ground_.links->block_count(), 0);
  for (const int32_t block : choice_.chosen) is_chosen[static_cast<size_t>(block)] = 1;
  for (size_t b = 0; b < is_chosen.size(); ++b) changes[b] = is_chosen[b] ^ blocks_.was_chosen[b];
  for (size_t b = 0; b < is_chosen.size(); ++b) {
    if (is_chosen[b] == 0) blocks_.stored[b].reset();
  }
  blocks_.was_chosen = std::move(is_chosen);
  for (const int32_t block : choice_.chosen) {
    std::unique_ptr<ReposeTile>& kept = blocks_.stored[static_cast<size_t>(block)];
    // cover_tile initialises it.
    if (kept == nullptr) kept = std::make_unique_for_overwrite<ReposeTile>();
    blocks_.tiles[static_cast<size_t>(block)] = std::move(kept);
  }
}

/// Call it when other objects near this one have moved.
void Repose::forget_rooms() {
  for (const std::unique_ptr<ReposeTile>& tile : blocks_.stored) {
    if (tile != nullptr) tile->ground.forget_rooms();
  }
}

/// Updates a tile; returns whether anything except its snow has changed.
bool Repose::cover_tile(int32_t block, const std::vector<float>& height) {
  ReposeTile& tile = *blocks_.tiles[static_cast<size_t>(block)];
  bool changes = !tile.ground.has_pose;
  const bool bare = choice_.highest[static_cast<size_t>(block)] == 0.0f;
  // A tile that was and stays bare need not be covered again.
  const bool stays_bare = bare && !changes && tile.snow.is_bare && !tile.snow.has_moved();
  if (changes) {
    tile.begin_pose();
    ground_.surface.fill_block(*ground_.links, block, tile.ground);
    const std::vector<int32_t>& places = ground_.table().texel;
    ground_.links->for_texels(block, places, [&](int32_t texel, size_t cell) {
      const auto place = static_cast<size_t>(places[static_cast<size_t>(texel)]);
      tile.cover(cell, height[place], ground_.surface.unit());
    });
  } else if (!stays_bare) {
    const BlockRect rect = rect_of(*ground_.links, block);
    changes = tile.cover_rows(&height[rect.place], static_cast<size_t>(ground_.links->resolution),
                              rect.size, ground_.surface.unit());
  }
  tile.begin_step(bare);
  for (OutletLink& outlet : blocks_.outlet_links[static_cast<size_t>(block)]) {
    outlet.flow = 0.0f;
    outlet.fallen = 0.0;
  }
  return changes;
}

void Repose::set_up(const std::vector<float>& height, bool on_all_cores) {
  if (choice_.chosen.empty()) return;
  const auto for_blocks = [&](const Blocks& blocks, const auto& work) {
    for_each_block(blocks.size(), on_all_cores, [&](size_t i) { work(blocks[i]); });
  };
  Marks changes(ground_.links->block_count(), 0);
  reuse_tiles(changes);
  for (size_t b = 0; b < stand_.changed.size(); ++b) changes[b] |= stand_.changed[b];
  for_blocks(choice_.chosen, [&](int32_t b) {
    if (cover_tile(b, height)) changes[static_cast<size_t>(b)] = 1;
  });
  std::vector<ChangedCells> rooms(choice_.chosen.size());
  for_each_block(choice_.chosen.size(), on_all_cores, [&](size_t i) {
    const int32_t b = choice_.chosen[i];
    if (choice_.is_partial) {
      rooms[i] = clear_rooms(*blocks_.tiles[static_cast<size_t>(b)]);
    } else if (rays_ != nullptr) {
      rooms[i] = fill_rooms(ground_, *rays_, choice_.limits, blocks_.tiles, b);
    }
  });
  Blocks changed;
  for (size_t i = 0; i < rooms.size(); ++i) {
    if (rooms[i].is_at_seam) changes[static_cast<size_t>(choice_.chosen[i])] = 1;
  }
  for (size_t b = 0; b < changes.size(); ++b) {
    if (changes[b] != 0) changed.push_back(static_cast<int32_t>(b));
  }
  Marks are_near(ground_.links->block_count(), 0);
  for (const int32_t block : near_blocks(*ground_.links, changed)) {
    are_near[static_cast<size_t>(block)] = 1;
  }
  for (size_t i = 0; i < rooms.size(); ++i) {
    mark_around(ground_.links->blocks_a_side, choice_.chosen[i], rooms[i].around, are_near);
  }
  Blocks unlinked;
  for (size_t b = 0; b < are_near.size(); ++b) {
    if (are_near[b] != 0 && blocks_.tiles[b] != nullptr) {
      unlinked.push_back(static_cast<int32_t>(b));
    }
  }
  for_blocks(unlinked, [&](int32_t b) {
    ReposeTile& tile = *blocks_.tiles[static_cast<size_t>(b)];
    tile.links.has_limits = false;
    set_up_outlets(ground_, choice_.limits, stand_.height, b, blocks_);
  });
}

}  // namespace snowbough::snow
