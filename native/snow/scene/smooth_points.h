#pragma once

#include <cstdint>
#include <vector>

#include "shaders/lib/snow_shared.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// The smooth points of a scene: corners of triangles that share a normal
/// (shaders/lib/smooth_points.h). All empty where every receiver is shaded flat.
struct SmoothPoints {
  /// Per triangle of the scene: the points at its corners, w unused; kNowhere: shaded flat.
  std::vector<shared::uvec4> of_triangle;
  /// Point p's corners, 3 * triangle + corner: [begin[p], begin[p + 1]) of `corners`, ascending.
  std::vector<uint32_t> begin;
  std::vector<uint32_t> corners;

  size_t count() const { return begin.empty() ? 0 : begin.size() - 1; }
};

/// `objects` in drawing order, their triangles in the scene one object's behind the other's. Of a
/// triangle of which some corners are shaded smooth, the others are points of their own.
SmoothPoints find_smooth_points(const std::vector<const SceneObject*>& objects);

}  // namespace snowbough::snow
