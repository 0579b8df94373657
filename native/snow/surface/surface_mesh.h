#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// A receiver as the surface is planned on it: in the pose of the shot's last frame.
struct SurfaceSource {
  /// Triangles, texture coordinates and the map's resolution.
  MapTopology topology;
  /// Metres, in the world.
  std::vector<glm::vec3> positions;
  /// Empty, or three a triangle: corners of one number share a smooth normal, -1 is flat.
  std::vector<int32_t> shading;
};

/// A mesh that lies on a receiver's faces. Points are shared by faces that meet, whatever their
/// charts do; texture coordinates belong to corners.
struct SurfaceMesh {
  /// Metres.
  std::vector<glm::vec3> position;
  std::vector<std::array<int32_t, 3>> triangle;
  std::vector<std::array<glm::vec2, 3>> uv;
  /// Unit normals as the receiver is shaded.
  std::vector<std::array<glm::vec3, 3>> normal;
  /// Of each triangle the receiver's triangle that it lies in.
  std::vector<int32_t> base;
};

/// Edges of a mesh, each once.
struct SurfaceEdges {
  /// The smaller point first; ascending.
  std::vector<std::array<int32_t, 2>> ends;
  /// Of each triangle the edges from corner k to corner k + 1.
  std::vector<std::array<int32_t, 3>> of_triangle;
};

SurfaceEdges surface_edges(const std::vector<std::array<int32_t, 3>>& triangles);

/// Twice the area of a triangle times its unit normal.
glm::vec3 triangle_cross(const SurfaceMesh& mesh, size_t triangle);
/// Unit normals, (0, 0, 0) for a triangle without area.
std::vector<glm::vec3> triangle_normals(const SurfaceMesh& mesh);

/// The receiver's own faces as a SurfaceMesh, without those that have no area; points in one place
/// are one.
SurfaceMesh receiver_mesh(const SurfaceSource& source);

/// Takes the triangles for which keep[t] is not 0, and the points that they use.
SurfaceMesh kept_part(const SurfaceMesh& mesh, const std::vector<uint8_t>& keep);

/// Splits edges, each at one place and both faces alike, so that no T-junctions appear.
/// @param share of each edge, where to split it between its ends, 0 < share < 1; outside of that it
/// stays whole.
void split_edges(SurfaceMesh& mesh, const SurfaceEdges& edges, const std::vector<float>& share);

/// Marks, in addition to `marked` edges, the longest edge of every triangle that has a marked one,
/// until nothing changes: triangles that are halved there keep their angles.
/// @param spared  edges (1) that are left out, so that the second longest counts in their
/// triangles.
///
/// Source: M.-C. Rivara, Algorithms for Refining Triangular Grids, IJNME 20, 1984.
void mark_longest(const SurfaceMesh& mesh, const SurfaceEdges& edges,
                  const std::vector<uint8_t>& spared, std::vector<uint8_t>& marked);

}  // namespace snowbough::snow
