#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "tree/obj/obj_scene.h"

namespace snowbough::tree {

/// An OBJ scene split into its index-connected components ("parts"), numbered by their first face.
///
/// Components are split by index alone, without welding: in real exports different branches touch
/// (welding Betula lenta at 1e-5 would fuse 167 of 1,348), but never share an index.
struct Parts {
  /// Faces of part p: faces[face_begin[p] .. face_begin[p + 1]), in the order of the file.
  std::vector<int32_t> faces;
  std::vector<int32_t> face_begin{0};
  /// Vertices of part p: vertices[vertex_begin[p] .. vertex_begin[p + 1]), ascending.
  std::vector<int32_t> vertices;
  std::vector<int32_t> vertex_begin{0};
  /// Per part: the run (index into ObjScene::runs) of its first face.
  std::vector<int32_t> run;

  int32_t count() const { return static_cast<int32_t>(run.size()); }
  std::span<const int32_t> part_faces(int32_t part) const {
    return {faces.data() + face_begin[part], faces.data() + face_begin[part + 1]};
  }
  std::span<const int32_t> part_vertices(int32_t part) const {
    return {vertices.data() + vertex_begin[part], vertices.data() + vertex_begin[part + 1]};
  }
};

/// Splits by vertex index; unused vertices belong to no part.
/// @param progress receives 0..1.
Parts split_parts(const ObjScene& scene, const base::Progress& progress = {});

/// Area of a part's polygons in square units of the file.
double part_area(const ObjScene& scene, const Parts& parts, int32_t part);

}  // namespace snowbough::tree
