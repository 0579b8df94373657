#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// What is right and wrong with a quad mesh.
struct MeshCheck {
  /// Pieces connected by edges.
  int32_t components = 0;
  /// Vertices - edges + faces of each piece; 2 for a closed surface without handles.
  std::vector<int32_t> euler;
  /// Edges of one face only.
  int32_t boundary_edges = 0;
  /// Edges of more than two faces, and faces that OpenMesh cannot join without pinching a vertex.
  int32_t nonmanifold_edges = 0;
  int32_t nonmanifold_faces = 0;
  /// Edges that both their faces run through in the same direction.
  int32_t flipped_edges = 0;
  /// Faces with a repeated corner, or with an area of at most 1e-14 of the mesh's squared extent.
  int32_t zero_area_faces = 0;
  /// Vertices that no face uses.
  int32_t unused_vertices = 0;
  /// No edge is flipped, and every closed piece encloses a positive volume (outward winding).
  bool winding_ok = true;
  /// Enclosed volume, summed over the pieces.
  double volume = 0.0;

  bool closed() const {
    return boundary_edges == 0 && nonmanifold_edges == 0 && nonmanifold_faces == 0;
  }
};

/// @throws std::invalid_argument for corner indices out of range.
void require_corners(const std::vector<Quad>& quads, size_t vertex_count);

/// Counts edges by their end points and walks around every vertex; what is no clean surface is
/// joined face by face in OpenMesh.
/// @throws std::invalid_argument for corner indices out of range.
MeshCheck check_mesh(const std::vector<glm::vec3>& vertices, const std::vector<Quad>& quads);

}  // namespace snowbough::tree
