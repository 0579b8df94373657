#include "snow/movement/repose/ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "snow/movement/rays/map_point.h"

namespace snowbough::snow {
namespace {

/// The outlet above a wall: at its upper end.
Outlet wall_outlet(const ReposeGround& ground, const OutletLink& link,
                   const std::vector<glm::vec3>& positions) {
  const TexelNow wall = texel_now(*ground.object, ground.table(), positions,
                                  texel_at(ground.table(), -1 - link.number));
  Outlet outlet;
  outlet.point = wall.point;
  // Poses differ by a turn about the vertical and a translation.
  outlet.point.z = static_cast<double>(ground.surface.anchor().z + link.bare + link.rise) +
                   static_cast<double>(positions.front().z) -
                   static_cast<double>(ground.pose.positions().front().z);
  outlet.outwards = glm::dvec2(wall.normal);
  const double length = glm::length(outlet.outwards);
  // Undersides have no horizontal direction.
  outlet.outwards = length > 0.1 ? outlet.outwards / length : glm::dvec2(0.0);
  outlet.reach = 0.5 * std::sqrt(wall.area);
  outlet.is_wall = true;
  return outlet;
}

}  // namespace

bool update_ground(ReposeGround& ground, bool curved) {
  ground.has_pose = true;
  const SceneObject& object = *ground.object;
  if (!ground.pose.set(object.description.rest, object.positions,
                       object.description.topology.vertex_count)) {
    return false;
  }
  if (ground.links == nullptr) {
    const std::vector<glm::vec3>& rest = object.description.rest;
    ground.links = ground.link_tables->find(object.description.topology, ground.shared_table(),
                                            rest.empty() ? object.positions : rest);
  }
  ground.surface.set_pose(object, ground.table(), ground.pose.positions(), curved);
  ground.own_rays.set_pose(ground.pose.positions());
  ground.has_bare = false;
  ground.edges.clear();
  return true;
}

/// A point of the surface, if its vertices are at `positions`.
glm::dvec3 point_on(const ReposeGround& ground, const ReposeLinks::Point& at,
                    const std::vector<glm::vec3>& positions) {
  const int32_t* const corners =
      &ground.object->description.topology.triangles[3 * static_cast<size_t>(at.triangle)];
  const auto corner = [&](int k) { return glm::dvec3(positions[static_cast<size_t>(corners[k])]); };
  const glm::dvec3 a = corner(0);
  return a + static_cast<double>(at.weights.x) * (corner(1) - a) +
         static_cast<double>(at.weights.y) * (corner(2) - a);
}

Outlet outlet_of(const ReposeGround& ground, const OutletLink& link) {
  return outlet_of(ground, link, ground.object->positions);
}

Outlet outlet_of(const ReposeGround& ground, const OutletLink& link,
                 const std::vector<glm::vec3>& positions) {
  if (link.number < 0) return wall_outlet(ground, link, positions);
  const auto number = static_cast<size_t>(link.number);
  const ReposeLinks& links = *ground.links;
  const ReposeLinks::Point& at = number >= links.across.size()
                                     ? links.open_edges[number - links.across.size()].point
                                     : links.across[number].seam;
  Outlet outlet;
  outlet.point = point_on(ground, at, positions);
  const auto own = static_cast<size_t>(link.texel);
  const glm::dvec3 inwards =
      point_on(ground, {ground.table().triangle[own], ground.table().barycentric[own]}, positions) -
      outlet.point;
  // The point lies on the side of its triangle that is opposite to the corner without weight.
  const std::array<float, 3> weights{1.0f - at.weights.x - at.weights.y, at.weights.x,
                                     at.weights.y};
  const auto least = std::min_element(weights.begin(), weights.end()) - weights.begin();
  const auto corner = [&](ptrdiff_t k) {
    const auto number = 3 * static_cast<ptrdiff_t>(at.triangle) + (least + k) % 3;
    const int32_t vertex =
        ground.object->description.topology.triangles[static_cast<size_t>(number)];
    return glm::dvec3(positions[static_cast<size_t>(vertex)]);
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
  const ReposeSurface::Texel texel = ground.surface.texel(link.texel);
  outlet.reach = 0.5 * std::sqrt(static_cast<double>(texel.area));
  return outlet;
}

}  // namespace snowbough::snow
