// Which blocks repose looks at, and their links.
#include <algorithm>
#include <cmath>
#include <limits>

#include "shaders/lib/texel_repose.h"
#include "snow/repose/repose.h"

namespace snowbough::snow {
namespace {

constexpr float kNoLink = std::numeric_limits<float>::infinity();

}  // namespace

/// A cell of a tile.
struct Repose::Cell {
  const ReposeTile* tile = nullptr;
  size_t at = 0;

  /// Whether there is a surface.
  bool is_there() const { return tile != nullptr && tile->area[at] > 0.0f; }
  bool is_wall() const { return (tile->kind[at] & kWall) != 0; }
  glm::vec3 point() const { return {tile->x[at], tile->y[at], tile->z[at]}; }
  glm::vec3 normal() const { return {tile->normal_x[at], tile->normal_y[at], tile->normal_z[at]}; }
};

void Repose::take_pose() {
  if (links_.resolution == 0) {
    const std::vector<glm::vec3>& rest = object_->description.rest;
    links_ = find_repose_links(object_->description.topology, object_->table,
                               rest.empty() ? object_->positions : rest);
    tiles_.resize(links_.block_count());
    kept_.resize(links_.block_count());
    rims_.resize(links_.block_count());
    across_.resize(links_.across.size());
  }
  surface_.set_pose(*object_);
  slack_.assign(links_.block_count(), {});
  for (const std::unique_ptr<ReposeTile>& tile : kept_) {
    if (tile != nullptr) tile->has_pose = false;
  }
  has_pose_ = true;
}

/// The highest snow in a block and beside it, and the largest difference across a link that it
/// keeps.
Repose::Relief Repose::relief_of(int32_t block, const std::vector<float>& height) const {
  Relief relief;
  const std::vector<int32_t>& places = object_->table.texel;
  const auto compare = [&](float own, size_t place) {
    const float other = std::abs(height[place]);
    relief.step = std::max(relief.step, std::abs(own - other));
    relief.high = std::max(relief.high, other);
  };
  links_.for_texels(block, places, [&](int32_t texel, size_t) {
    const auto place = static_cast<size_t>(places[static_cast<size_t>(texel)]);
    const float own = std::abs(height[place]);
    relief.high = std::max(relief.high, own);
    const uint8_t forward = links_.forward[static_cast<size_t>(texel)];
    const auto side = static_cast<size_t>(links_.resolution);
    if ((forward & 1) != 0) compare(own, place + 1);
    if ((forward & 2) != 0) compare(own, place + side);
    if ((forward & 4) != 0) compare(own, place + side + 1);
    if ((forward & 8) != 0) compare(own, place + side - 1);
  });
  const int32_t* ends = &links_.end_begin[static_cast<size_t>(block)];
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = links_.ends[static_cast<size_t>(e)];
    if (end.sign > 0 || static_cast<size_t>(end.link) >= across_.size()) continue;
    const auto other = static_cast<size_t>(links_.across[static_cast<size_t>(end.link)].b);
    const auto place = static_cast<size_t>(places[static_cast<size_t>(end.texel)]);
    compare(std::abs(height[place]), static_cast<size_t>(places[other]));
  }
  return relief;
}

/// Whether no link of the block can be over its limit. Two points whose heights differ by at most
/// `step` and their normals by `turn`, fall by at most step + high * turn more than bare and come
/// nearer by as much.
bool Repose::is_level(int32_t block, const Relief& relief) const {
  if (relief.high <= 0.0f) return true;
  const BlockSlack& slack = slack_[static_cast<size_t>(block)];
  return slack.is_known &&
         (1.0f + slope_) * (relief.step + relief.high * slack.turn) <= slack.inside &&
         (1.0f + slope_) * relief.high <= slack.at_edges;
}

size_t Repose::choose_blocks(const std::vector<float>& height, float slope) {
  has_changed_ = false;
  chosen_.clear();
  stands_still_ = has_pose_;
  if (!has_pose_) {
    const bool is_bare = std::all_of(height.begin(), height.end(), [](float h) { return h == 0; });
    if (is_bare) return 0;
    take_pose();
  }
  if (slope != slope_) slack_.assign(slack_.size(), {});
  slope_ = slope;
  doubtful_.clear();
  for (size_t b = 0; b < slack_.size(); ++b) {
    const auto block = static_cast<int32_t>(b);
    if (!is_level(block, relief_of(block, height))) doubtful_.push_back(block);
  }
  chosen_ = near(doubtful_);
  return chosen_.size();
}

/// Takes note of a link for is_level.
void Repose::note_slack(const Cell& a, const Cell& b, BlockSlack& slack) const {
  if (!a.is_there() || !b.is_there() || (a.is_wall() && b.is_wall())) return;
  const glm::vec3 way = b.point() - a.point();
  const float bare =
      shared::kEven * slope_ * std::sqrt(way.x * way.x + way.y * way.y) - std::abs(way.z);
  if (a.is_wall() || b.is_wall()) {
    const bool falls = a.is_wall() ? way.z > 0.0f : way.z < 0.0f;
    if (falls) slack.at_edges = std::min(slack.at_edges, bare);
    return;
  }
  slack.inside = std::min(slack.inside, bare);
  const glm::vec3 turn = b.normal() - a.normal();
  slack.turn = std::max(slack.turn, std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z));
}

Repose::Cell Repose::across_end(int32_t link, size_t end) const {
  const int32_t cell = links_.across_cells[static_cast<size_t>(link)][end];
  return {tiles_[static_cast<size_t>(cell / kTileCells)].get(),
          static_cast<size_t>(cell % kTileCells)};
}

/// What is known of a block from now on, until its surface moves. Only where all that it is linked
/// with was looked at.
void Repose::find_slack(int32_t block) {
  BlockSlack slack{true, kNoLink, kNoLink, 0.0f};
  const ReposeTile* const tile = tiles_[static_cast<size_t>(block)].get();
  links_.for_texels(block, object_->table.texel, [&](int32_t texel, size_t cell) {
    const int32_t column = static_cast<int32_t>(cell) % kReposeBlock;
    const int32_t row = static_cast<int32_t>(cell) / kReposeBlock;
    for (size_t k = 0; k < kForwardLinks; ++k) {
      if (((links_.forward[static_cast<size_t>(texel)] >> k) & 1) == 0) continue;
      const int32_t x = column + kForwardColumn[k] + kReposeBlock;
      const int32_t y = row + kForwardRow[k];
      const int32_t other = block + y / kReposeBlock * links_.blocks_a_side + x / kReposeBlock - 1;
      note_slack({tile, cell},
                 {tiles_[static_cast<size_t>(other)].get(),
                  static_cast<size_t>(y % kReposeBlock * kReposeBlock + x % kReposeBlock)},
                 slack);
    }
  });
  const int32_t* ends = &links_.end_begin[static_cast<size_t>(block)];
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = links_.ends[static_cast<size_t>(e)];
    if (end.sign < 0 && static_cast<size_t>(end.link) < across_.size()) {
      note_slack(across_end(end.link, 0), across_end(end.link, 1), slack);
    }
  }
  for (const RimLink& rim : rims_[static_cast<size_t>(block)]) {
    slack.at_edges = std::min(slack.at_edges, rim.slack);
  }
  slack_[static_cast<size_t>(block)] = slack;
}

/// Over a rim into the air, or onto a wall: `at` is the lower point, and bare.
RimLink Repose::rim_link(const Cell& a, const glm::vec3& at) const {
  RimLink link;
  link.cell = static_cast<int32_t>(a.at);
  link.top = at.z;
  link.limit = link.slack = kNoLink;
  if (!a.is_there() || a.is_wall()) return link;
  const glm::vec3 way = at - a.point();
  link.limit = shared::link_limit(way.x, way.y, way.x - a.tile->cover_x[a.at],
                                  way.y - a.tile->cover_y[a.at], slope_);
  link.rate = shared::link_rate(a.tile->stiffness[a.at], 0.0f);
  link.slack = shared::kEven * slope_ * std::sqrt(way.x * way.x + way.y * way.y) - std::abs(way.z);
  return link;
}

void Repose::set_up_ends(int32_t block) {
  std::vector<RimLink>& rims = rims_[static_cast<size_t>(block)];
  rims.clear();
  const ReposeTile* const tile = tiles_[static_cast<size_t>(block)].get();
  const int32_t* ends = &links_.end_begin[static_cast<size_t>(block)];
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = links_.ends[static_cast<size_t>(e)];
    const auto link = static_cast<size_t>(end.link);
    const Cell own{tile, static_cast<size_t>(end.cell % kTileCells)};
    if (link >= across_.size()) {
      const ReposeLinks::Rim& rim = links_.rims[link - across_.size()];
      rims.push_back(rim_link(own, surface_.point(rim.triangle, rim.weights)));
      continue;
    }
    const Cell a = across_end(end.link, 0);
    const Cell b = across_end(end.link, 1);
    const Cell& other = end.sign < 0 ? b : a;
    Flow& flow = across_[link];
    if (end.sign < 0) flow.limit = kNoLink;
    if (!own.is_there() || !other.is_there() || own.is_wall()) continue;
    if (other.is_wall()) {
      if (other.point().z < own.point().z) rims.push_back(rim_link(own, other.point()));
      continue;
    }
    if (end.sign > 0) continue;
    const glm::vec3 way = b.point() - a.point();
    flow.limit =
        shared::link_limit(way.x, way.y, way.x + b.tile->cover_x[b.at] - a.tile->cover_x[a.at],
                           way.y + b.tile->cover_y[b.at] - a.tile->cover_y[a.at], slope_);
    flow.rate = shared::link_rate(a.tile->stiffness[a.at], b.tile->stiffness[b.at]);
  }
}

void Repose::set_up(const std::vector<float>& height) {
  for (const int32_t block : chosen_) {
    std::unique_ptr<ReposeTile>& kept = kept_[static_cast<size_t>(block)];
    if (kept == nullptr) kept = std::make_unique<ReposeTile>();
    tiles_[static_cast<size_t>(block)] = std::move(kept);
  }
  const std::vector<int32_t>& places = object_->table.texel;
  for_blocks(chosen_, [&](int32_t b) {
    ReposeTile& tile = *tiles_[static_cast<size_t>(b)];
    if (!tile.has_pose) surface_.fill_block(links_, b, tile);
    links_.for_texels(b, places, [&](int32_t texel, size_t cell) {
      const auto place = static_cast<size_t>(places[static_cast<size_t>(texel)]);
      tile.cover(cell, height[place], surface_.unit());
    });
  });
  for_blocks(chosen_, [&](int32_t b) {
    set_up_tile_links(tiles_, b, links_.blocks_a_side, slope_);
    set_up_ends(b);
  });
  // On a surface that moves all is new in the next step.
  if (!stands_still_) return;
  for_blocks(doubtful_, [&](int32_t b) {
    if (!slack_[static_cast<size_t>(b)].is_known) find_slack(b);
  });
}

}  // namespace snowbough::snow
