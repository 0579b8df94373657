// Repose: choosing blocks and setting up their links.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/granular.h"
#include "snow/movement/repose/height_range.h"
#include "snow/movement/repose/repose.h"
#include "snow/movement/repose/tiles_around.h"

namespace snowbough::snow {
namespace {

/// Rays from a texel pass surfaces within this fraction of its half width.
constexpr float kOwnSurface = 0.02f;

}  // namespace

void Repose::find_links() {
  const std::vector<glm::vec3>& rest = object_->description.rest;
  links_ = link_tables_->find(object_->description.topology, shared_table(),
                              rest.empty() ? object_->positions : rest);
  tiles_.resize(links_->block_count());
  stored_tiles_.resize(links_->block_count());
  rims_.resize(links_->block_count());
  across_.resize(links_->across.size());
  is_noted_.assign(links_->block_count(), 0);
  was_chosen_.assign(links_->block_count(), 0);
}

/// Evaluates the surface, if it has changed for repose.
void Repose::update_pose() {
  has_pose_ = true;
  if (!pose_.set(object_->description.rest, object_->positions,
                 object_->description.topology.vertex_count)) {
    return;
  }
  if (links_ == nullptr) find_links();
  surface_.set_pose(*object_, table(), pose_.positions(), limits_.cohesion > 0.0f);
  own_rays_.set_pose(pose_.positions());
  slack_.assign(links_->block_count(), std::nullopt);
  has_bare_ = false;
  for (const std::unique_ptr<ReposeTile>& tile : stored_tiles_) {
    if (tile != nullptr) tile->ground.has_pose = false;
  }
}

/// A block's texels on the map: the first place, and the numbers of columns and rows.
Repose::BlockRect Repose::rect_of(int32_t block) const {
  const int32_t size = links_->resolution;
  const int32_t left = block % links_->blocks_a_side * kReposeBlock;
  const int32_t first = block / links_->blocks_a_side * kReposeBlock;
  return {static_cast<size_t>(first) * static_cast<size_t>(size) + static_cast<size_t>(left),
          {std::min(kReposeBlock, size - left), std::min(kReposeBlock, size - first)}};
}

float Repose::highest_in(int32_t block, const std::vector<float>& height) const {
  const BlockRect rect = rect_of(block);
  return highest_of(&height[rect.place], static_cast<size_t>(links_->resolution), rect.size);
}

/// Whether it is certain that no link of a block exceeds its limit.
bool Repose::rests(int32_t block, const std::vector<float>& height) {
  const auto b = static_cast<size_t>(block);
  const int32_t* const near = &links_->near_begin[b];
  const bool is_bare =
      std::all_of(links_->near.begin() + near[0], links_->near.begin() + near[1],
                  [&](int32_t n) { return highest_[static_cast<size_t>(n)] == 0.0f; });
  if (is_bare) return true;
  const float own = highest_[b];
  // Snow too high to be level needs no closer examination.
  if (own > 0.0f && !slack_of(block).is_level(own, 0.0f)) return false;
  const HeightRange range = find_height_range(*links_, table().texel, block, height.data());
  if (range.high == 0.0f) return true;
  const BlockSlack& slack = slack_of(block);
  if (slack.side > 0.0f ? range.any_back : range.any_front) return false;
  return slack.is_level(range.high, range.step);
}

const BlockSlack& Repose::slack_of(int32_t block) {
  std::optional<BlockSlack>& slack = slack_[static_cast<size_t>(block)];
  if (!slack) slack = find_slack(surface_, *links_, table().texel, block, limits_);
  return *slack;
}

/// Releases the tiles, and treats all blocks as new in the next step.
void Repose::forget_tiles() {
  for (std::unique_ptr<ReposeTile>& tile : stored_tiles_) tile.reset();
  was_chosen_.assign(was_chosen_.size(), 0);
  ways_.blocks.clear();
}

/// Returns false if no snow lies on the map.
bool Repose::begin_choice(const std::vector<float>& height, const ReposeLimits& limits) {
  has_changed_ = is_partial_ = false;
  rounds_ = 0.0;
  chosen_.clear();
  blades_.clear();
  releases_.clear();
  if (limits != limits_) {
    // Curvatures are only needed with cohesion.
    if ((limits.cohesion > 0.0f) != (limits_.cohesion > 0.0f)) {
      has_pose_ = false;
      pose_ = {};
    }
    limits_ = limits;
    slack_.assign(slack_.size(), std::nullopt);
    // Treat all blocks as new.
    was_chosen_.assign(was_chosen_.size(), 0);
  }
  if (!has_pose_) {
    const bool is_bare = std::all_of(height.begin(), height.end(), [](float h) { return h == 0; });
    if (is_bare) return false;
    update_pose();
  }
  highest_.resize(slack_.size());
  return true;
}

size_t Repose::choose_blocks(const std::vector<float>& height, const ReposeLimits& limits,
                             const std::vector<int32_t>& blades, bool only_there) {
  const bool has_snow = begin_choice(height, limits);
  if (!has_snow || (only_there && blades.empty())) return 0;
  is_partial_ = only_there;
  if (!blades.empty()) blades_.assign(slack_.size(), 0);
  for (const int32_t block : blades) blades_[static_cast<size_t>(block)] = 1;
  if (is_partial_) {
    chosen_ = near(blades);
    for (const int32_t block : near(chosen_)) {
      highest_[static_cast<size_t>(block)] = highest_in(block, height);
    }
    return chosen_.size();
  }
  base::for_each_item(slack_.size(), 64,
                      [&](size_t b) { highest_[b] = highest_in(static_cast<int32_t>(b), height); });
  Marks are_doubtful(slack_.size(), 0);
  base::for_each_item(slack_.size(), 16, [&](size_t b) {
    are_doubtful[b] = rests(static_cast<int32_t>(b), height) ? 0 : 1;
  });
  Blocks doubtful;
  for (size_t b = 0; b < slack_.size(); ++b) {
    if (are_doubtful[b] != 0) doubtful.push_back(static_cast<int32_t>(b));
  }
  chosen_ = near(doubtful);
  if (chosen_.empty()) forget_tiles();
  return chosen_.size();
}

/// Provides the tiles of the chosen blocks, reusing those of the last run; marks the blocks that
/// were added or removed.
void Repose::reuse_tiles(Marks& changes) {
  if (is_partial_) {
    tiles_.swap(stored_tiles_);
    for (const int32_t block : chosen_) {
      std::unique_ptr<ReposeTile>& tile = tiles_[static_cast<size_t>(block)];
      if (tile != nullptr) continue;
      tile = std::make_unique_for_overwrite<ReposeTile>();
      was_chosen_[static_cast<size_t>(block)] = changes[static_cast<size_t>(block)] = 1;
    }
    return;
  }
  Marks is_chosen(links_->block_count(), 0);
  for (const int32_t block : chosen_) is_chosen[static_cast<size_t>(block)] = 1;
  for (size_t b = 0; b < is_chosen.size(); ++b) changes[b] = is_chosen[b] ^ was_chosen_[b];
  for (size_t b = 0; b < is_chosen.size(); ++b) {
    if (is_chosen[b] == 0) stored_tiles_[b].reset();
  }
  was_chosen_ = std::move(is_chosen);
  for (const int32_t block : chosen_) {
    std::unique_ptr<ReposeTile>& kept = stored_tiles_[static_cast<size_t>(block)];
    // cover_tile initialises it.
    if (kept == nullptr) kept = std::make_unique_for_overwrite<ReposeTile>();
    tiles_[static_cast<size_t>(block)] = std::move(kept);
  }
}

/// A point of the surface, if its vertices are at `positions`.
glm::dvec3 Repose::point_on(const ReposeLinks::Point& at,
                            const std::vector<glm::vec3>& positions) const {
  const int32_t* const corners =
      &object_->description.topology.triangles[3 * static_cast<size_t>(at.triangle)];
  const auto corner = [&](int k) { return glm::dvec3(positions[static_cast<size_t>(corners[k])]); };
  const glm::dvec3 a = corner(0);
  return a + static_cast<double>(at.weights.x) * (corner(1) - a) +
         static_cast<double>(at.weights.y) * (corner(2) - a);
}

glm::dvec3 Repose::world_point(int32_t texel) const {
  const auto i = static_cast<size_t>(texel);
  return world_point({table().triangle[i], table().barycentric[i]});
}

/// Finds the room above the texels onto which snow may flow, and marks those whose room is full;
/// returns whether that has changed for any. It depends on this step's snow only.
bool Repose::fill_rooms(int32_t block) {
  ReposeTile& tile = *tiles_[static_cast<size_t>(block)];
  const std::array<uint32_t, kReposeBlock> wanted =
      cells_below_snow(TilesAround(tiles_, links_->blocks_a_side, block),
                       (limits_.is_granular ? kGranularSure : shared::kEven) * limits_.slope);
  uint32_t rows = 0;
  for (uint32_t row = 0; row < kReposeBlock; ++row) rows |= (wanted[row] != 0 ? 1u : 0u) << row;
  if (rows == 0 && !tile.snow.any_full) return false;
  std::array<uint32_t, kReposeBlock> full{};
  const auto find_room = [&](int32_t texel, size_t cell) {
    float& room = tile.ground.room[cell];
    const auto column = static_cast<uint32_t>(cell % kReposeBlock);
    if (((wanted[cell / kReposeBlock] >> column) & 1) == 0) return;
    if (room < 0.0f) room = room_above(texel, cell, tile);
    const float rise = tile.snow.top[cell] - tile.ground.z[cell];
    if (rise >= room && !tile.snow.is_wall(cell)) {
      full[cell / kReposeBlock] |= 1u << column;
    }
  };
  links_->for_texels(block, table().texel, find_room, rows);
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

/// Marks no texel as full; returns whether any was.
bool Repose::clear_rooms(int32_t block) {
  TileSnow& snow = tiles_[static_cast<size_t>(block)]->snow;
  if (!snow.any_full) return false;
  for (uint8_t& kind : snow.kind) kind &= static_cast<uint8_t>(~kFull);
  snow.any_full = false;
  return true;
}

/// The vertical distance from a texel to the first surface above, 0 within a body.
float Repose::room_above(int32_t texel, size_t cell, ReposeTile& tile) {
  const float reach = 0.5f * std::sqrt(tile.ground.area[cell]);
  const double least = kOwnSurface * reach;
  const glm::dvec3 up(0.0, 0.0, 1.0);
  const auto room_below = [&](const SurfaceHit& above) {
    const auto room = static_cast<float>(above.distance);
    // Nothing flows into a slit.
    return above.is_inside(false) || room < reach ? 0.0f : room;
  };
  const bool is_rigid = pose_.is_rigid();
  const float others = room_below(rays_->first_along(world_point(texel), up, least,
                                                     std::numeric_limits<double>::infinity(),
                                                     is_rigid ? object_ : nullptr));
  if (!is_rigid) return others;
  float& own = tile.ground.own_room[cell];
  if (own < 0.0f) {
    const auto i = static_cast<size_t>(texel);
    const glm::dvec3 from =
        point_on({table().triangle[i], table().barycentric[i]}, pose_.positions());
    const auto hit =
        own_rays_.first_along(from, up, least, std::numeric_limits<double>::infinity());
    own = room_below(own_rays_.surface_at(hit, 0, from, up));
  }
  return std::min(own, others);
}

/// Call it when other objects near this one have moved.
void Repose::forget_rooms() {
  for (const std::unique_ptr<ReposeTile>& tile : stored_tiles_) {
    if (tile != nullptr) tile->ground.forget_rooms();
  }
}

/// Updates a tile; returns whether anything except its snow has changed.
bool Repose::cover_tile(int32_t block, const std::vector<float>& height) {
  ReposeTile& tile = *tiles_[static_cast<size_t>(block)];
  bool changes = !tile.ground.has_pose;
  const bool bare = highest_[static_cast<size_t>(block)] == 0.0f;
  // A tile that was and stays bare need not be covered again.
  const bool stays_bare = bare && !changes && tile.snow.is_bare && !tile.snow.has_moved();
  if (changes) {
    tile.begin_pose();
    surface_.fill_block(*links_, block, tile.ground);
    const std::vector<int32_t>& places = table().texel;
    links_->for_texels(block, places, [&](int32_t texel, size_t cell) {
      const auto place = static_cast<size_t>(places[static_cast<size_t>(texel)]);
      tile.cover(cell, height[place], surface_.unit());
    });
  } else if (!stays_bare) {
    const BlockRect rect = rect_of(block);
    changes = tile.cover_rows(&height[rect.place], static_cast<size_t>(links_->resolution),
                              rect.size, surface_.unit());
  }
  tile.begin_step(bare);
  for (RimLink& rim : rims_[static_cast<size_t>(block)]) {
    rim.flow = 0.0f;
    rim.fallen = 0.0;
  }
  return changes;
}

void Repose::set_up(const std::vector<float>& height, bool on_all_cores) {
  if (chosen_.empty()) return;
  on_all_cores_ = on_all_cores;
  Marks changes(links_->block_count(), 0);
  reuse_tiles(changes);
  for (size_t b = 0; b < restands_.size(); ++b) changes[b] |= restands_[b];
  for_blocks(chosen_, [&](int32_t b) {
    if (cover_tile(b, height)) changes[static_cast<size_t>(b)] = 1;
  });
  for_blocks(chosen_, [&](int32_t b) {
    if (is_partial_ ? clear_rooms(b) : rays_ != nullptr && fill_rooms(b)) {
      changes[static_cast<size_t>(b)] = 1;
    }
  });
  Blocks changed;
  for (size_t b = 0; b < changes.size(); ++b) {
    if (changes[b] != 0) changed.push_back(static_cast<int32_t>(b));
  }
  Blocks unlinked;
  for (const int32_t block : near(changed)) {
    if (tiles_[static_cast<size_t>(block)] != nullptr) unlinked.push_back(block);
  }
  for_blocks(unlinked, [&](int32_t b) {
    tiles_[static_cast<size_t>(b)]->links.has_limits = false;
    set_up_ends(b);
  });
}

}  // namespace snowbough::snow
