#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/movement/rays/scene_rays.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// A texel of a receiver's map, under a point in the air.
struct MapPoint {
  /// Index of the object, sorted by name; -1: none.
  int32_t object = -1;
  /// row * resolution + column; -1 on an object without a map.
  int32_t place = -1;
  /// World height of the bare surface in metres.
  float z = 0.0f;
  /// shared::column_height of the texel, or without one, of the surface; 0: it holds no snow.
  float column = 1.0f;
  /// Whether snow lies on the back there.
  bool is_back = false;
};

/// The texel under a hit on `object`, at world height `z`.
MapPoint map_point(const SceneObject& object, const RayHit& hit, double z);

/// Whether snow comes to lie on a surface: it is no wall and no underside.
bool holds_snow(const RayHit& hit);

/// The first surface that holds snow, within `length` metres from a point along a unit vector.
RayHit first_ground(const SceneRays& rays, const glm::dvec3& from, const glm::dvec3& direction,
                    double length);

/// A texel in a pose, flat.
struct TexelNow {
  glm::dvec3 point{0.0};
  /// Mean normal of its faces.
  glm::dvec3 normal{0.0};
  /// In m2.
  double area = 0.0;
};

/// A texel of `table`, the object's or a coarser one, if the object's vertices are at `positions`.
TexelNow texel_now(const SceneObject& object, const TexelTable& table,
                   const std::vector<glm::vec3>& positions, int32_t texel);

/// The texel at a place of the map, -1: none.
int32_t texel_at(const TexelTable& table, int32_t place);

}  // namespace snowbough::snow
