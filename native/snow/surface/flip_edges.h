#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// A corner of a triangle; it also stands for the edge from there to the next corner.
struct TriangleCorner {
  int32_t triangle = -1;
  int32_t k = 0;
};

/// The corners at which an edge starts, in the first two of its triangles.
struct EdgeCorners {
  std::array<TriangleCorner, 2> corner;
  /// Number of triangles at the edge.
  int32_t count = 0;
};
std::vector<EdgeCorners> edge_corners(const SurfaceEdges& edges);

/// Whether the triangles at the edge that starts at corner a and, in the other one, at corner b lie
/// in one face of the receiver, or in two that are flat and of one chart: the edge may turn there.
bool are_one_face(const SurfaceMesh& mesh, const TriangleCorner& a, const TriangleCorner& b);

/// Diagonals of long, narrow, flat quads: 1, other edges 0. Halving them would halve the quads'
/// width with their length, again in each round. Halve the long sides instead, then turn the
/// diagonals.
std::vector<uint8_t> sliver_diagonals(const SurfaceMesh& mesh, const SurfaceEdges& edges);

/// Turns edges within the receiver's flat faces until each is the shorter diagonal of its two
/// triangles where snow lies, so that triangles follow folds and hems.
///
/// Source: N. Dyn, D. Levin, S. Rippa, Data Dependent Triangulations for Piecewise Linear
/// Interpolation, IMA Journal of Numerical Analysis 10, 1990.
/// @param shown the points of the snow, one a point of the mesh.
void flip_edges(SurfaceMesh& mesh, const std::vector<glm::vec3>& shown);

}  // namespace snowbough::snow
