#pragma once

#include "tree/original/original_uvs.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// The coordinates and materials of the four-sided base, mesh.base, from those of the mesh that was
/// refined from it: a base quad has the material of the part nearest to its middle. Its corners are
/// vertices of its parts; their coordinates continue those of that part, across the seams of tiled
/// images too, where they jump by whole numbers. Parts beyond other seams are not used: there the
/// corner has the coordinates of the nearest vertex on this side.
///
/// @param fine  original_uvs of `mesh`. Without coordinates there are none.
/// @throws std::invalid_argument if the mesh has no base, or `fine` is of another mesh.
OriginalUvs base_uvs(const TreeMesh& mesh, const OriginalUvs& fine);

}  // namespace snowbough::tree
