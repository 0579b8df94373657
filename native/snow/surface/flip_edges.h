#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// A corner of a triangle. It also represents the edge from this corner to the next one.
struct TriangleCorner {
  int32_t triangle = -1;
  int32_t k = 0;
};

/// The corners at which an edge starts in its first two triangles.
struct EdgeCorners {
  std::array<TriangleCorner, 2> corner;
  /// Number of triangles at the edge.
  int32_t count = 0;
};
std::vector<EdgeCorners> edge_corners(const SurfaceEdges& edges);

/// True if the edge may be flipped. The edge starts at corner `a` in one triangle and at corner `b`
/// in the other. Both triangles must lie in one face of the receiver, or in two coplanar faces of
/// one chart.
bool are_one_face(const SurfaceMesh& mesh, const TriangleCorner& a, const TriangleCorner& b);

/// Returns 1 for the diagonals of long, narrow, flat quads and 0 for other edges. Halving a
/// diagonal would halve the quad's width as well as its length in each round. The caller halves the
/// long sides instead and flips the diagonals afterwards.
std::vector<uint8_t> sliver_diagonals(const SurfaceMesh& mesh, const SurfaceEdges& edges);

/// Flips edges within flat faces of the receiver until each edge, where snow lies, is the shorter
/// diagonal of its two triangles. The triangles then follow folds and hems.
///
/// Source: N. Dyn, D. Levin, S. Rippa, Data Dependent Triangulations for Piecewise Linear
/// Interpolation, IMA Journal of Numerical Analysis 10, 1990.
/// @param shown points of the snow surface, one per point of the mesh.
void flip_edges(SurfaceMesh& mesh, const std::vector<glm::vec3>& shown);

}  // namespace snowbough::snow
