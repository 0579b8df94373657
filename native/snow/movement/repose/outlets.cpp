// Repose: the outlets of blocks, over which snow leaves the map: rims of the surface and walls.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "shaders/lib/texel_repose.h"
#include "snow/movement/rays/map_point.h"
#include "snow/movement/repose/granular.h"
#include "snow/movement/repose/repose.h"
#include "snow/movement/repose/tiles_around.h"

namespace snowbough::snow {
namespace {

/// Least depth of snow, in horizontal ways from there to an outlet.
constexpr float kDepthsOfWay = 1.0f;

}  // namespace

/// A cell of a tile.
struct Repose::Cell {
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
float Repose::link_limit(const Cell& a, const glm::vec3& at, float curvature, float steep,
                         float leads_down) const {
  const glm::vec3 way = at - a.point();
  const float even = limits_.is_granular ? kGranularRest / shared::kEven : 1.0f;
  const float slope = shared::held_slope(even * limits_.slope, limits_.cohesion, curvature);
  return shared::link_limit(std::sqrt(way.x * way.x + way.y * way.y), slope, way.z, steep,
                            leads_down);
}

float Repose::link_limit(const Cell& a, const Cell& b, float leads_down) const {
  return link_limit(a, b.point(), 0.5f * (a.curvature() + b.curvature()),
                    0.5f * (a.steep() + b.steep()), leads_down);
}

/// The cell in a column and a row of a block, or of those around.
Repose::Cell Repose::cell_at(const TilesAround& around, int32_t column, int32_t row) {
  constexpr int32_t kInner = kReposeBlock - 1;
  const ReposeTile* const tile =
      around.at(column < 0 ? -1 : column / kReposeBlock, row < 0 ? -1 : row / kReposeBlock);
  return {tile, static_cast<size_t>((row & kInner) * kReposeBlock + (column & kInner))};
}

Repose::Cell Repose::across_end(int32_t link, size_t end) const {
  const int32_t cell = links_->across_cells[static_cast<size_t>(link)][end];
  return {tiles_[static_cast<size_t>(cell / kTileCells)].get(),
          static_cast<size_t>(cell % kTileCells)};
}

/// A link over a rim into the air, or over a seam onto a wall; `at`: the end of the surface.
RimLink Repose::rim_link(const Cell& a, const ReposeLinks::End& end, const glm::vec3& at) const {
  RimLink link;
  link.cell = static_cast<int32_t>(a.at);
  link.number = end.link;
  link.texel = end.texel;
  link.bare = link.top = at.z;
  link.limit = kNoLink;
  if (!a.is_there() || a.is_wall()) return link;
  link.limit = link_limit(a, at, a.curvature(), a.steep(), shared::kAllLeadDown);
  link.rate = shared::link_rate(a.tile->stiffness(a.at), 0.0f);
  return link;
}

void Repose::set_up_ends(int32_t block) {
  std::vector<RimLink>& rims = rims_[static_cast<size_t>(block)];
  rims.clear();
  const ReposeTile* const tile = tiles_[static_cast<size_t>(block)].get();
  const int32_t* ends = &links_->end_begin[static_cast<size_t>(block)];
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = links_->ends[static_cast<size_t>(e)];
    const auto link = static_cast<size_t>(end.link);
    const Cell own{tile, static_cast<size_t>(end.cell % kTileCells)};
    if (link >= across_.size()) {
      const ReposeLinks::Rim& rim = links_->rims[link - across_.size()];
      rims.push_back(rim_link(own, end, surface_.point(rim.point)));
      continue;
    }
    const Cell a = across_end(end.link, 0);
    const Cell b = across_end(end.link, 1);
    const Cell& other = end.sign < 0 ? b : a;
    Flow& flow = across_[link];
    if (end.sign < 0) flow.limit = kNoLink;
    if (!own.is_there() || !other.is_there() || own.is_wall()) continue;
    if (other.is_wall()) {
      if (!(other.point().z < own.point().z)) continue;
      rims.push_back(rim_link(own, end, surface_.point(links_->across[link].seam)));
      continue;
    }
    if (end.sign > 0) continue;
    flow.limit = link_limit(a, b, shared::kAllLeadDown);
    if (stand_ != nullptr) {
      const ReposeLinks::Across& across = links_->across[link];
      const std::vector<int32_t>& places = table().texel;
      flow.limit = std::max(flow.limit, stands(places[static_cast<size_t>(across.a)],
                                               places[static_cast<size_t>(across.b)]));
    }
    flow.rate = shared::link_rate(a.tile->stiffness(a.at), b.tile->stiffness(b.at));
  }
  link_walls(block);
}

/// Calls visit(cell, column, row) for the cells around one on the map to which it is linked.
template <typename Visit>
void Repose::for_linked(const TilesAround& around, int32_t column, int32_t row,
                        const Visit& visit) const {
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

/// Adds links onto walls beside a block's cells: snow falls over them as over rims.
void Repose::link_walls(int32_t block) {
  const TilesAround around(tiles_, links_->blocks_a_side, block);
  const auto has_wall = [](const ReposeTile* tile) {
    return tile != nullptr && tile->outlets.any_wall;
  };
  if (std::none_of(around.tiles.begin(), around.tiles.end(), [&](const auto& row) {
        return std::any_of(row.begin(), row.end(), has_wall);
      })) {
    return;
  }
  std::vector<RimLink>& rims = rims_[static_cast<size_t>(block)];
  const size_t before = rims.size();
  const auto place_of = [&](int32_t column, int32_t row) {
    return (block / links_->blocks_a_side * kReposeBlock + row) * links_->resolution +
           block % links_->blocks_a_side * kReposeBlock + column;
  };
  for (int32_t own = 0; own < kTileCells; ++own) {
    const Cell a{around.at(0, 0), static_cast<size_t>(own)};
    if (!a.is_there() || a.is_wall()) continue;
    const int32_t column = own % kReposeBlock;
    const int32_t row = own / kReposeBlock;
    for_linked(around, column, row, [&](const Cell& b, int32_t x, int32_t y) {
      if (!b.is_there() || !b.is_wall() || !(b.point().z < a.point().z)) return;
      RimLink link;
      link.cell = own;
      link.number = -1 - place_of(x, y);
      link.bare = link.top = b.point().z;
      // The wall's upper end, halfway down the cell's own slope.
      const glm::vec3 way = b.point() - a.point();
      link.rise = -way.z - 0.5f * std::min(-way.z, a.steep() * std::hypot(way.x, way.y));
      link.limit = link_limit(a, b, shared::kLeadsDown);
      if (stand_ != nullptr) {
        link.limit = std::max(link.limit, stands(place_of(column, row), place_of(x, y)));
      }
      link.rate = shared::link_rate(a.tile->stiffness(a.at), 0.0f);
      rims.push_back(link);
    });
  }
  if (rims.size() == before) return;
  std::stable_sort(rims.begin(), rims.end(),
                   [](const RimLink& one, const RimLink& other) { return one.cell < other.cell; });
}

Repose::Outlet Repose::outlet(const RimLink& rim) const {
  if (rim.number < 0) return wall_outlet(rim);
  const auto link = static_cast<size_t>(rim.number);
  const ReposeLinks::Point& at = link >= across_.size() ? links_->rims[link - across_.size()].point
                                                        : links_->across[link].seam;
  Outlet outlet;
  outlet.point = world_point(at);
  const glm::dvec3 inwards = world_point(rim.texel) - outlet.point;
  // The point lies on the side of its triangle that is opposite to the corner without weight.
  const std::array<float, 3> weights{1.0f - at.weights.x - at.weights.y, at.weights.x,
                                     at.weights.y};
  const auto least = std::min_element(weights.begin(), weights.end()) - weights.begin();
  const auto corner = [&](ptrdiff_t k) {
    const auto number = 3 * static_cast<ptrdiff_t>(at.triangle) + (least + k) % 3;
    const int32_t vertex = object_->description.topology.triangles[static_cast<size_t>(number)];
    return glm::dvec3(object_->positions[static_cast<size_t>(vertex)]);
  };
  const glm::dvec3 side = corner(2) - corner(1);
  glm::dvec2 outwards(side.y, -side.x);
  double length = glm::length(outwards);
  // A side that is nearly upright has no horizontal perpendicular.
  if (!(length > 0.1 * glm::length(side))) {
    outwards = -glm::dvec2(inwards);
    length = glm::length(outwards);
  }
  if (length > 0.0) outlet.outwards = outwards / length;
  if (glm::dot(outlet.outwards, glm::dvec2(inwards)) > 0.0) outlet.outwards *= -1.0;
  const ReposeSurface::Texel texel = surface_.texel(rim.texel);
  outlet.reach = 0.5 * std::sqrt(static_cast<double>(texel.area));
  return outlet;
}

/// The outlet above a wall: at its upper end.
Repose::Outlet Repose::wall_outlet(const RimLink& rim) const {
  const TexelNow wall = texel_now(*object_, table(), texel_at(table(), -1 - rim.number));
  Outlet outlet;
  outlet.point = wall.point;
  // Poses differ by a turn about the vertical and a translation.
  outlet.point.z = static_cast<double>(surface_.anchor().z + rim.bare + rim.rise) +
                   static_cast<double>(object_->positions.front().z) -
                   static_cast<double>(pose_.positions().front().z);
  outlet.outwards = glm::dvec2(wall.normal);
  const double length = glm::length(outlet.outwards);
  // Undersides have no horizontal direction.
  outlet.outwards = length > 0.1 ? outlet.outwards / length : glm::dvec2(0.0);
  outlet.reach = 0.5 * std::sqrt(wall.area);
  outlet.is_wall = true;
  return outlet;
}

float Repose::highest_near(int32_t block) const {
  float highest = 0.0f;
  const int32_t* const near = &links_->near_begin[static_cast<size_t>(block)];
  for (int32_t n = near[0]; n < near[1]; ++n) {
    highest =
        std::max(highest, highest_[static_cast<size_t>(links_->near[static_cast<size_t>(n)])]);
  }
  return highest;
}

/// Whether snow lies on the first cell up the slope from an outlet that is not too steep for it,
/// and is thick beside the way there: bevels carry none themselves.
bool Repose::is_below_snow(int32_t block, const RimLink& rim) const {
  const TilesAround around(tiles_, links_->blocks_a_side, block);
  int32_t column = rim.cell % kReposeBlock;
  int32_t row = rim.cell / kReposeBlock;
  Cell cell = cell_at(around, column, row);
  const glm::vec2 from(cell.point());
  // Farther ones may be in blocks beyond those around.
  for (int32_t step = 0; step < kReposeBlock / 2 && cell.steep() > limits_.slope; ++step) {
    Cell next = cell;
    glm::ivec2 at(column, row);
    for_linked(around, column, row, [&](const Cell& other, int32_t x, int32_t y) {
      if (!other.is_there() || other.is_wall() || !(other.point().z > next.point().z)) return;
      next = other;
      at = {x, y};
    });
    if (next.at == cell.at && next.tile == cell.tile) break;
    cell = next;
    column = at.x;
    row = at.y;
  }
  const float thick = cell.tile->snow.top[cell.at] - cell.point().z;
  return thick > 0.0f && thick >= kDepthsOfWay * glm::distance(glm::vec2(cell.point()), from);
}

float Repose::top_over(int32_t block, const RimLink& rim) const {
  return tiles_[static_cast<size_t>(block)]->snow.top[static_cast<size_t>(rim.cell)] - rim.bare -
         rim.rise;
}

}  // namespace snowbough::snow
