#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "tree/rings/local_mesh.h"

namespace snowbough::tree {

using LocalTriangle = std::array<int32_t, 3>;

/// The polygons as triangle fans, in their order.
std::vector<LocalTriangle> triangulate(const LocalMesh& mesh);

/// The pairs of vertices joined by a triangle edge, each once, ascending.
std::vector<std::array<int32_t, 2>> edges_of(const std::vector<LocalTriangle>& triangles);

/// Distance of every vertex from the nearest of `sources` along the surface; infinite if
/// unreachable. Paths run along edges and, unfolded, straight across pairs of neighbouring
/// triangles, which overestimates by a few per cent.
/// @throws Cancelled when progress says stop.
///
/// Sources: E. W. Dijkstra, "A note on two problems in connexion with graphs", Numerische
/// Mathematik 1, 1959; the unfolding: R. Kimmel, J. A. Sethian, "Computing geodesic paths on
/// manifolds", PNAS 95, 1998.
std::vector<double> geodesic_distances(const LocalMesh& mesh,
                                       const std::vector<LocalTriangle>& triangles,
                                       std::span<const int32_t> sources,
                                       const base::Progress& progress = {});

}  // namespace snowbough::tree
