#pragma once

#include <vector>

#include "base/triangle_tree.h"
#include "snow/surface/rims.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// Distances in metres: the greatest ones searched over the supporting and down the far faces, and
/// the greatest width of a strip.
struct RimReach {
  float support, far, strip;
};

/// Finds the rims of a mesh. A rim is an edge between a face that carries snow and one that goes
/// down from it, an open edge of a face that carries snow, or a strip of narrow faces over which
/// the surface turns down, such as a bevel. A strip gives one rim: the line at which the planes of
/// the carrying and the far face meet.
///
/// @param mesh the result of receiver_mesh.
/// @param tree a tree over the triangles of `mesh`.
/// @param shading as in SurfaceSource.
/// @param parts the result of face_parts.
std::vector<Rim> find_rims(const SurfaceMesh& mesh, const base::TriangleTree& tree,
                           const std::vector<int32_t>& shading, const std::vector<int32_t>& parts,
                           const RimReach& reach);

}  // namespace snowbough::snow
