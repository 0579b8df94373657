#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "snow/movement/rays/map_point.h"
#include "snow/movement/rays/object_rays.h"
#include "snow/movement/repose/links.h"
#include "snow/movement/repose/pose.h"
#include "snow/movement/repose/surface.h"
#include "snow/movement/repose/tile_links.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// The bare surface of all texels in a pose, up to a translation and a rotation about the vertical.
struct BareTexels {
  /// By place on the map; -1: none.
  std::vector<int32_t> texel_of;
  /// By texel: metres, upward part of the normal, m2.
  std::vector<float> x, y, z, up, area;
  /// Of all texels, in m2.
  double whole_area = 0.0;
};

/// The edge that the surface before an outlet would end in without its bevel or rounding.
struct RoundedEdge {
  /// Distance in metres from the outlet within which it has been searched; infinite if it is not to
  /// be searched further.
  float searched = 0.0f;
  /// Height in metres over the outlet; 0: not found yet. And the surface inland of the rounding.
  float height = 0.0f;
  MapPoint inland;
};

/// What a receiver's snow lies on: the links of its texels, and its surface in the current pose.
struct ReposeGround {
  /// As for Repose.
  ReposeGround(const SceneObject& own, ReposeLinkTables& tables,
               std::shared_ptr<const TexelTable> coarser)
      : object(&own), coarse(std::move(coarser)), link_tables(&tables), own_rays(own) {}

  const SceneObject* object;
  /// The texels of a coarser map; null: the object's own.
  std::shared_ptr<const TexelTable> coarse;
  ReposeLinkTables* link_tables;
  /// Shared with copies of the object; null before the first pose.
  std::shared_ptr<const ReposeLinks> links;
  /// Whether the rest is of the current pose.
  bool has_pose = false;
  ReposePose pose;
  ReposeSurface surface;
  /// Rays against pose.positions().
  ObjectRays own_rays;
  /// Call bare_texels before using these. By texel: the last texel of its way down the bare
  /// surface, and -1 - the outlet to which it leads, or the last texel again. Gain: 28 % of a bake.
  bool has_bare = false;
  BareTexels bare;
  std::vector<int32_t> way_last, way_end;

  /// By block and cell: see raise_rounded_edges.
  std::vector<std::map<int32_t, RoundedEdge>> edges;

  const std::shared_ptr<const TexelTable>& shared_table() const {
    return coarse != nullptr ? coarse : object->table;
  }
  /// The texels of its map.
  const TexelTable& table() const { return *shared_table(); }
  /// The number of outlets that do not depend on the pose: OutletLink::number from 0 on.
  size_t outlet_count() const { return links->across.size() + links->open_edges.size(); }
};

/// Evaluates the current pose. `curved`: see ReposeSurface::set_pose. Returns whether it differs
/// for repose from the last one.
bool update_ground(ReposeGround& ground, bool curved);

/// A point of the surface, if its vertices are at `positions`.
glm::dvec3 point_on(const ReposeGround& ground, const ReposeLinks::Point& at,
                    const std::vector<glm::vec3>& positions);

/// The end of the surface at an outlet, in the world.
struct Outlet {
  glm::dvec3 point{0.0};
  /// Horizontal unit vector away from the surface, or 0.
  glm::dvec2 outwards{0.0};
  /// Half a texel, in metres.
  double reach = 0.0;
  /// Whether it is above a wall in the same chart.
  bool is_wall = false;
};
Outlet outlet_of(const ReposeGround& ground, const OutletLink& link);
/// The same, if the object's vertices are at `positions`.
Outlet outlet_of(const ReposeGround& ground, const OutletLink& link,
                 const std::vector<glm::vec3>& positions);

/// Snow that left the map.
struct Release {
  static constexpr int32_t kOffWall = -1;
  static constexpr int32_t kInHollow = -2;
  static constexpr int32_t kThrough = -3;
  /// The outlet over which it fell, see OutletLink::number; or one of these: it fell off a wall,
  /// found no way out of a hollow, or falls through the surface that let it go.
  int32_t outlet = kOffWall;
  /// The outlet's texel, the wall's, or the hollow's lowest.
  int32_t texel = 0;
  /// In m3.
  double volume = 0.0;
};

/// The first call in a pose evaluates it.
const BareTexels& bare_texels(ReposeGround& ground);
/// The next texel straight down the bare surface; or the end of the way: -1 - outlet, or the texel
/// itself, if it is a hollow or, unless the way leads `over_walls`, a wall. After bare_texels.
int32_t next_down(const ReposeGround& ground, int32_t texel, bool over_walls = false);
/// Where snow on a texel ends if it slides down the bare surface.
Release way_down(ReposeGround& ground, int32_t texel);

}  // namespace snowbough::snow
