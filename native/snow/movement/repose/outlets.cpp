#include "snow/movement/repose/outlets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/granular.h"
#include "snow/movement/repose/tiles_around.h"

namespace snowbough::snow {
namespace {

/// A cell of a tile.
struct Cell {
  const ReposeTile* tile = nullptr;
  size_t at = 0;

  bool is_there() const {
    return tile != nullptr && tile->ground.area[at] > 0.0f && !tile->snow.is_full(at);
  }
  bool is_wall() const { return (tile->snow.kind[at] & kWall) != 0; }
  glm::vec3 point() const { return {tile->ground.x[at], tile->ground.y[at], tile->ground.z[at]}; }
  float curvature() const { return tile->ground.curvature[at]; }
  float steep() const { return shared::bare_slope(tile->ground.up[at]); }
};

/// The limit of a link from a cell to a point `at`, with the bare surface's curvature and slope
/// there.
float link_limit(const ReposeLimits& limits, const Cell& a, const glm::vec3& at, float curvature,
                 float steep, float leads_down) {
  const glm::vec3 way = at - a.point();
  const float even = limits.is_granular ? kGranularRest / shared::kEven : 1.0f;
  const float slope = shared::held_slope(even * limits.slope, limits.cohesion, curvature);
  return shared::link_limit(std::sqrt(way.x * way.x + way.y * way.y), slope, way.z, steep,
                            leads_down);
}

float link_limit(const ReposeLimits& limits, const Cell& a, const Cell& b, float leads_down) {
  return link_limit(limits, a, b.point(), 0.5f * (a.curvature() + b.curvature()),
                    0.5f * (a.steep() + b.steep()), leads_down);
}

/// The cell in a column and a row of a block, or of those around.
Cell cell_at(const TilesAround& around, int32_t column, int32_t row) {
  constexpr int32_t kInner = kReposeBlock - 1;
  const ReposeTile* const tile =
      around.at(column < 0 ? -1 : column / kReposeBlock, row < 0 ? -1 : row / kReposeBlock);
  return {tile, static_cast<size_t>((row & kInner) * kReposeBlock + (column & kInner))};
}

Cell across_end(const ReposeLinks& links, const ReposeTiles& tiles, int32_t link, size_t end) {
  const int32_t cell = links.across_cells[static_cast<size_t>(link)][end];
  return {tiles[static_cast<size_t>(cell / kTileCells)].get(),
          static_cast<size_t>(cell % kTileCells)};
}

/// A link over an open edge into the air, or over a seam onto a wall; `at`: the end of the surface.
OutletLink outlet_link(const ReposeLimits& limits, const Cell& a, const ReposeLinks::End& end,
                       const glm::vec3& at) {
  OutletLink link;
  link.cell = static_cast<int32_t>(a.at);
  link.number = end.link;
  link.texel = end.texel;
  link.bare = link.top = at.z;
  link.limit = kNoLink;
  if (!a.is_there() || a.is_wall()) return link;
  link.limit = link_limit(limits, a, at, a.curvature(), a.steep(), shared::kAllLeadDown);
  link.rate = shared::link_rate(a.tile->stiffness(a.at), 0.0f);
  return link;
}

/// Calls visit(cell, column, row) for the cells around one on the map to which it is linked.
template <typename Visit>
void for_linked(const TilesAround& around, int32_t column, int32_t row, const Visit& visit) {
  const Cell own = cell_at(around, column, row);
  for (int32_t k = 0; k < kForwardLinks; ++k) {
    for (const int32_t sign : {1, -1}) {
      const int32_t x = column + sign * kForwardColumn[k];
      const int32_t y = row + sign * kForwardRow[k];
      const Cell other = cell_at(around, x, y);
      const Cell& giver = sign > 0 ? own : other;
      if (giver.tile != nullptr && ((giver.tile->ground.forward[giver.at] >> k) & 1) != 0) {
        visit(other, x, y);
      }
    }
  }
}

/// Adds links onto walls beside a block's cells: snow falls over them as over open edges.
void link_walls(const ReposeGround& ground, const ReposeLimits& limits,
                const std::vector<float>* stand, int32_t block, ReposeBlocks& blocks) {
  const TilesAround around(blocks.tiles, ground.links->blocks_a_side, block);
  const auto has_wall = [](const ReposeTile* tile) {
    return tile != nullptr && tile->outlets.any_wall;
  };
  if (std::none_of(around.tiles.begin(), around.tiles.end(), [&](const auto& row) {
        return std::any_of(row.begin(), row.end(), has_wall);
      })) {
    return;
  }
  std::vector<OutletLink>& outlet_links = blocks.outlet_links[static_cast<size_t>(block)];
  const size_t before = outlet_links.size();
  const auto place_of = [&](int32_t column, int32_t row) {
    return (block / ground.links->blocks_a_side * kReposeBlock + row) * ground.links->resolution +
           block % ground.links->blocks_a_side * kReposeBlock + column;
  };
  for (int32_t own = 0; own < kTileCells; ++own) {
    const Cell a{around.at(0, 0), static_cast<size_t>(own)};
    if (!a.is_there() || a.is_wall()) continue;
    const int32_t column = own % kReposeBlock;
    const int32_t row = own / kReposeBlock;
    for_linked(around, column, row, [&](const Cell& b, int32_t x, int32_t y) {
      if (!b.is_there() || !b.is_wall() || !(b.point().z < a.point().z)) return;
      OutletLink link;
      link.cell = own;
      link.number = -1 - place_of(x, y);
      link.bare = link.top = b.point().z;
      // The wall's upper end, halfway down the cell's own slope.
      const glm::vec3 way = b.point() - a.point();
      link.rise = -way.z - 0.5f * std::min(-way.z, a.steep() * std::hypot(way.x, way.y));
      link.limit = link_limit(limits, a, b, shared::kLeadsDown);
      if (stand != nullptr) {
        link.limit = std::max(link.limit, stands(*stand, place_of(column, row), place_of(x, y)));
      }
      link.rate = shared::link_rate(a.tile->stiffness(a.at), 0.0f);
      outlet_links.push_back(link);
    });
  }
  if (outlet_links.size() == before) return;
  std::stable_sort(
      outlet_links.begin(), outlet_links.end(),
      [](const OutletLink& one, const OutletLink& other) { return one.cell < other.cell; });
}

}  // namespace

float stands(const std::vector<float>& stand, int32_t a, int32_t b) {
  return std::max(stand[static_cast<size_t>(a)], stand[static_cast<size_t>(b)]);
}

void set_up_outlets(const ReposeGround& ground, const ReposeLimits& limits,
                    const std::vector<float>* stand, int32_t block, ReposeBlocks& blocks) {
  std::vector<OutletLink>& outlet_links = blocks.outlet_links[static_cast<size_t>(block)];
  outlet_links.clear();
  const ReposeTile* const tile = blocks.tiles[static_cast<size_t>(block)].get();
  const int32_t* ends = &ground.links->end_begin[static_cast<size_t>(block)];
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = ground.links->ends[static_cast<size_t>(e)];
    const auto link = static_cast<size_t>(end.link);
    const Cell own{tile, static_cast<size_t>(end.cell % kTileCells)};
    if (link >= ground.links->across.size()) {
      const ReposeLinks::OpenEdge& edge =
          ground.links->open_edges[link - ground.links->across.size()];
      outlet_links.push_back(outlet_link(limits, own, end, ground.surface.point(edge.point)));
      continue;
    }
    const Cell a = across_end(*ground.links, blocks.tiles, end.link, 0);
    const Cell b = across_end(*ground.links, blocks.tiles, end.link, 1);
    const Cell& other = end.sign < 0 ? b : a;
    SeamFlows::Link& flow = blocks.flows.links[link];
    if (end.sign < 0) flow.limit = kNoLink;
    if (!own.is_there() || !other.is_there() || own.is_wall()) continue;
    if (other.is_wall()) {
      if (!(other.point().z < own.point().z)) continue;
      outlet_links.push_back(
          outlet_link(limits, own, end, ground.surface.point(ground.links->across[link].seam)));
      continue;
    }
    if (end.sign > 0) continue;
    flow.limit = link_limit(limits, a, b, shared::kAllLeadDown);
    if (stand != nullptr) {
      const ReposeLinks::Across& across = ground.links->across[link];
      const std::vector<int32_t>& places = ground.table().texel;
      flow.limit = std::max(flow.limit, stands(*stand, places[static_cast<size_t>(across.a)],
                                               places[static_cast<size_t>(across.b)]));
    }
    flow.rate = shared::link_rate(a.tile->stiffness(a.at), b.tile->stiffness(b.at));
  }
  link_walls(ground, limits, stand, block, blocks);
}

namespace {

/// The highest cell linked to one that is too steep for snow; itself, if none is higher.
int32_t find_next_up(const ReposeGround& ground, const ReposeLimits& limits,
                     const ReposeBlocks& blocks, int32_t number) {
  const ReposeLinks& links = *ground.links;
  const auto cell_of = [&](int32_t own) {
    return Cell{blocks.tiles[static_cast<size_t>(own / kTileCells)].get(),
                static_cast<size_t>(own % kTileCells)};
  };
  if (!(cell_of(number).steep() > limits.slope)) return number;
  int32_t next = number;
  const auto consider = [&](int32_t other) {
    const Cell to = cell_of(other);
    if (to.is_there() && !to.is_wall() && to.point().z > cell_of(next).point().z) next = other;
  };
  const int32_t block = number / kTileCells;
  const TilesAround around(blocks.tiles, links.blocks_a_side, block);
  const int32_t side = links.blocks_a_side * kReposeBlock;
  const int32_t inner = number % kTileCells;
  const int32_t left = block % links.blocks_a_side * kReposeBlock;
  const int32_t low = block / links.blocks_a_side * kReposeBlock;
  for_linked(around, inner % kReposeBlock, inner / kReposeBlock,
             [&](const Cell&, int32_t column, int32_t row) {
               const int32_t x = left + column;
               const int32_t y = low + row;
               if (x >= 0 && y >= 0 && x < side && y < side) consider(links.cell_at(x, y));
             });
  links.for_across(number, [&](int32_t other, size_t) { consider(other); });
  return next;
}

}  // namespace

bool is_below_snow(const ReposeGround& ground, const ReposeLimits& limits,
                   const ReposeBlocks& blocks, int32_t block, const OutletLink& outlet) {
  const auto tile_of = [&](int32_t number) -> ReposeTile& {
    return *blocks.tiles[static_cast<size_t>(number / kTileCells)];
  };
  const auto point_of = [&](int32_t number) {
    const TileGround& own = tile_of(number).ground;
    const auto at = static_cast<size_t>(number % kTileCells);
    return glm::vec2(own.x[at], own.y[at]);
  };
  const int32_t first = block * kTileCells + outlet.cell;
  int32_t number = first;
  for (int step = 0; step < kReposeBlock; ++step) {
    const int32_t next = find_next_up(ground, limits, blocks, number);
    if (next == number) break;
    number = next;
  }
  const ReposeTile& tile = tile_of(number);
  const auto at = static_cast<size_t>(number % kTileCells);
  const float thick = tile.snow.top[at] - tile.ground.z[at];
  return thick > 0.0f && thick >= glm::distance(point_of(number), point_of(first));
}

float top_over(const ReposeBlocks& blocks, int32_t block, const OutletLink& outlet) {
  return blocks.tiles[static_cast<size_t>(block)]->snow.top[static_cast<size_t>(outlet.cell)] -
         outlet.bare - outlet.rise;
}

}  // namespace snowbough::snow
