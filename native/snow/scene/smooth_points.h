#pragma once

#include <cstdint>
#include <vector>

#include "shaders/lib/snow_shared.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// The smooth points of a scene: triangle corners that share a normal
/// (shaders/lib/smooth_points.h). All empty if every receiver is shaded flat.
struct SmoothPoints {
  /// Per triangle of the scene: the points at its corners, w unused; kNowhere: flat.
  std::vector<shared::uvec4> of_triangle;
  /// Point p's corners, 3 * triangle + corner: [begin[p], begin[p + 1]) of `corners`, ascending.
  std::vector<uint32_t> begin;
  std::vector<uint32_t> corners;

  size_t count() const { return begin.empty() ? 0 : begin.size() - 1; }
};

/// `objects` in drawing order; the scene's triangles are in the same order. If only some corners of
/// a triangle are smooth, the others get points of their own.
SmoothPoints find_smooth_points(const std::vector<const SceneObject*>& objects);

}  // namespace snowbough::snow
