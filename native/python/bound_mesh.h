#pragma once

#include <cstdint>
#include <vector>

#include "tree/build_tree_mesh.h"

namespace snowbough::python {

/// A mesh as Python sees it: the arrays and the build report.
struct BoundMesh {
  tree::TreeMesh mesh;
  tree::BuildReport report;
  /// After reduce_bones: old bone -> new bone.
  std::vector<int32_t> bone_map;
};

}  // namespace snowbough::python
