#pragma once

#include <cstdint>
#include <vector>

#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Copies parts of a file into a PolygonMesh, in the order and axes of the file. Materials are
/// those in use, by name only.
class PolygonGatherer {
 public:
  PolygonGatherer(const ObjScene& scene, const Parts& parts, PolygonMesh& mesh);

  /// @param repeated  whether to copy polygons that have a vertex twice.
  void add(int32_t part, bool repeated = true);

  /// Drops the normals if every corner has none or that of its flat polygon.
  /// @return whether they are those of flat polygons.
  bool finish();

 private:
  int32_t material_of(int32_t material);

  const ObjScene& scene_;
  const Parts& parts_;
  PolygonMesh& mesh_;
  /// Index in the file -> index in the mesh.
  std::vector<int32_t> material_number_;
  std::vector<int32_t> vertex_number_;
};

}  // namespace snowbough::tree
