#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// A receiver in the pose of the shot's last frame, for which the surface is planned.
struct SurfaceSource {
  /// Triangles, texture coordinates and the map's resolution.
  MapTopology topology;
  /// World space, in metres.
  std::vector<glm::vec3> positions;
  /// Empty, or three numbers per triangle: corners with the same number share a smooth normal; -1
  /// is flat.
  std::vector<int32_t> shading;
};

/// A mesh on the faces of a receiver. Adjacent faces share points even across charts; texture
/// coordinates belong to corners.
struct SurfaceMesh {
  /// Metres.
  std::vector<glm::vec3> position;
  std::vector<std::array<int32_t, 3>> triangle;
  std::vector<std::array<glm::vec2, 3>> uv;
  /// Unit normals of the receiver's shading.
  std::vector<std::array<glm::vec3, 3>> normal;
  /// The receiver's triangle that contains each triangle.
  std::vector<int32_t> base;
};

/// Edges of a mesh; each edge appears once.
struct SurfaceEdges {
  /// Point indices, the smaller one first; the edges are in ascending order.
  std::vector<std::array<int32_t, 2>> ends;
  /// The edges of each triangle, from corner k to corner k + 1.
  std::vector<std::array<int32_t, 3>> of_triangle;
};

SurfaceEdges surface_edges(const std::vector<std::array<int32_t, 3>>& triangles);

/// The triangle's unit normal times twice its area.
glm::vec3 triangle_cross(const SurfaceMesh& mesh, size_t triangle);
/// Unit normals, (0, 0, 0) for a triangle without area.
std::vector<glm::vec3> triangle_normals(const SurfaceMesh& mesh);

/// The receiver's own faces as a SurfaceMesh. Faces without area are left out and coincident points
/// are merged.
SurfaceMesh receiver_mesh(const SurfaceSource& source);

/// Returns the triangles with keep[t] other than 0, and the points that these triangles use.
SurfaceMesh submesh(const SurfaceMesh& mesh, const std::vector<uint8_t>& keep);

/// Splits each edge at one position that both of its faces share, so that no T-junctions appear.
/// @param share position of the split on each edge as a fraction of its length, 0 < share < 1. An
/// edge with a value outside this range is not split.
void split_edges(SurfaceMesh& mesh, const SurfaceEdges& edges, const std::vector<float>& share);

/// Extends `marked`: marks the longest edge of every triangle that has a marked edge, until nothing
/// changes. Triangles that are halved at these edges keep their angles.
/// @param spared 1 for edges that must not be marked; their triangles use the second longest edge.
///
/// Source: M.-C. Rivara, Algorithms for Refining Triangular Grids, IJNME 20, 1984.
void mark_longest(const SurfaceMesh& mesh, const SurfaceEdges& edges,
                  const std::vector<uint8_t>& spared, std::vector<uint8_t>& marked);

}  // namespace snowbough::snow
