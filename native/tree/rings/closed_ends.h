#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tree/rings/local_mesh.h"

namespace snowbough::tree {

/// Where a closed tube may end, as sets of vertices (ascending) to start a walk from: the vertices
/// farthest apart, in space and along the surface, the centres of fans and the polygons that close
/// a ring; each with the faces and flat patches around. No more than the first `most` of them.
Layers closed_ends(const LocalMesh& mesh, const Topology& topology, size_t most);

}  // namespace snowbough::tree
