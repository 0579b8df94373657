#pragma once

#include <cstdint>
#include <vector>

#include "shaders/lib/snow_shared.h"
#include "snow/scene/map_plan.h"
#include "snow/scene/smooth_points.h"

namespace snowbough::snow {

/// All objects of a scene in one set of arrays for the engines' passes, without positions and
/// texels. Objects are in drawing order (by name).
struct SceneLayout {
  MapPlan plan;
  /// Per object: its first vertex and triangle.
  std::vector<int32_t> first_vertex;
  std::vector<int32_t> first_triangle;
  /// Per object: its first triangle in `alpha_triangles`; -1: it is opaque and not in there.
  std::vector<int32_t> first_alpha;
  int32_t vertex_count = 0;

  std::vector<shared::SceneTriangle> triangles;
  /// Per triangle: its sheet (snow/texels/sheets.h), numbered across all objects.
  std::vector<uint32_t> triangle_sheets;
  /// Of receivers only, by slot.
  std::vector<shared::MapTriangle> map_triangles;
  /// By slot: offset from a triangle's index to its index in `map_triangles`.
  std::vector<int32_t> map_offsets;
  /// Only of objects with alpha; a mask that several objects share is stored once.
  std::vector<shared::AlphaTriangle> alpha_triangles;
  std::vector<shared::AlphaMaskHeader> alpha_headers;
  std::vector<uint32_t> alpha_bits;
  SmoothPoints smooth_points;
};

/// `objects` are sorted by name and have positions. `max_layers`: of a texture array.
SceneLayout lay_out_scene(const std::vector<const SceneObject*>& objects, int32_t max_layers);

/// The object index of every slot.
std::vector<size_t> objects_by_slot(const MapPlan& plan);

}  // namespace snowbough::snow
