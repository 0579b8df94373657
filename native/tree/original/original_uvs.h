#pragma once

#include <cstdint>
#include <vector>

#include "base/parallel_for.h"
#include "tree/skeleton/skeleton.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// The export's own texture coordinates and materials on a rebuilt mesh.
struct OriginalUvs {
  /// Per quad and corner. Where the export has no coordinates those of `bark`; empty where it has
  /// none anywhere.
  std::vector<QuadUv> uv;
  /// Per quad: index into OriginalWood::materials, -1 = none.
  std::vector<int32_t> material;
};

/// Looks up where the mesh lies on the tubes that it was rebuilt from, so that a texture sits where
/// its maker put it. A face is looked up on its own branch's polygons only, at the same height
/// along the limb and in the same direction from its axis (Unrolled): first its centre, which tells
/// its material, and from there its corners, so that all of them have coordinates of one side of a
/// seam. Past an open end of the tube coordinates run on.
///
/// @param mesh build_tree_mesh(skeleton), of any detail or level; with or without reduced bones.
/// @throws Cancelled when execution's progress says stop.
OriginalUvs original_uvs(const Skeleton& skeleton, const TreeMesh& mesh,
                         const base::Execution& execution = {});

}  // namespace snowbough::tree
