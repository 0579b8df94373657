#pragma once

#include <cstddef>

#include "tree/rings/local_mesh.h"

namespace snowbough::tree {

/// Candidate ends of a closed tube, as sets of vertices (ascending) from which to start a walk: the
/// vertices farthest apart, in space and along the surface, the centres of fans and the polygons
/// that close a ring; each with the adjacent faces and flat patches. At most the first `most` of
/// them.
Layers closed_ends(const LocalMesh& mesh, const Topology& topology, size_t most);

}  // namespace snowbough::tree
