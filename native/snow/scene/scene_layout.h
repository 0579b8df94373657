#pragma once

#include <cstdint>
#include <vector>

#include "shaders/lib/snow_shared.h"
#include "snow/scene/map_plan.h"
#include "snow/scene/smooth_points.h"

namespace snowbough::snow {

/// All objects of a scene in one set of arrays, as the engines' passes read them; positions and
/// texels excepted. Objects are in drawing order (by name).
struct SceneLayout {
  MapPlan plan;
  /// Per object: where its vertices and triangles begin.
  std::vector<int32_t> first_vertex;
  std::vector<int32_t> first_triangle;
  /// Per object: its first triangle among `alpha_triangles`; -1 = it is opaque and has none there.
  std::vector<int32_t> first_alpha;
  int32_t vertex_count = 0;

  std::vector<shared::SceneTriangle> triangles;
  /// Per triangle: its sheet (snow/texels/sheets.h), numbered through all objects.
  std::vector<uint32_t> triangle_sheets;
  /// Of receivers only, by slot.
  std::vector<shared::MapTriangle> map_triangles;
  /// By slot: what to add to a triangle's index to get its index among `map_triangles`.
  std::vector<int32_t> map_offsets;
  /// Of the objects with alpha only; masks that several objects share lie there once.
  std::vector<shared::AlphaTriangle> alpha_triangles;
  std::vector<shared::AlphaMaskPlace> alpha_places;
  std::vector<uint32_t> alpha_bits;
  SmoothPoints smooth_points;
};

/// `objects` are sorted by name and have positions. `max_layers`: of a texture array.
SceneLayout lay_out_scene(const std::vector<const SceneObject*>& objects, int32_t max_layers);

/// The object of every slot.
std::vector<size_t> objects_by_slot(const MapPlan& plan);

}  // namespace snowbough::snow
