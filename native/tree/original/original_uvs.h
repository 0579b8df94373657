#pragma once

#include <cstdint>
#include <vector>

#include "base/parallel_for.h"
#include "tree/skeleton/skeleton.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// The export's own texture coordinates and materials on a rebuilt mesh.
struct OriginalUvs {
  /// Per quad and corner. The `bark` UVs where the export has none; empty if it has none at all.
  std::vector<QuadUv> uv;
  /// Per quad: index into OriginalWood::materials, -1 = none.
  std::vector<int32_t> material;
};

/// Looks up the mesh on the tubes from which it was rebuilt, so that textures keep their place. A
/// face is looked up only on its own branch's polygons, at the same height along the limb and in
/// the same direction from its axis (Unrolled): first its centre, which gives the material, then
/// its corners from there, so that all corners are on one side of a seam. Beyond an open end of the
/// tube the coordinates are extrapolated.
///
/// @param mesh build_tree_mesh(skeleton), of any detail or level; with or without reduced bones.
/// @throws Cancelled when execution's progress says stop.
OriginalUvs original_uvs(const Skeleton& skeleton, const TreeMesh& mesh,
                         const base::Execution& execution = {});

}  // namespace snowbough::tree
