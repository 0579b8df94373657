#pragma once

#include "tree/mesh/weights.h"
#include "tree/skeleton/skeleton.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// Weights of the kept surface by construction: a vertex follows the bones at its place on its
/// branch. At a joint it takes half of each of the two bones, in the middle of a bone that bone
/// alone, and a mixture between. Where a branch leaves its parent, the surface follows the parent's
/// bones beside it as long as the branch's centreline is inside the parent, and passes to the
/// branch until it is twice the branch's radius away from the parent's surface.
/// @param skeleton  with an attached kept surface.
/// @param bones  of a mesh that was built from this skeleton, before bones are reduced.
/// @param max_influences  1 to 4.
/// @throws std::invalid_argument if a branch of the surface has no bones.
VertexWeights kept_weights(const Skeleton& skeleton, const Bones& bones, int max_influences);

}  // namespace snowbough::tree
