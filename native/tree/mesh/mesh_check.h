#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// Topology and geometry checks of a quad mesh.
struct MeshCheck {
  /// Number of edge-connected components.
  int32_t components = 0;
  /// Vertices - edges + faces per component; 2 for a closed surface without handles.
  std::vector<int32_t> euler;
  /// Edges with only one face.
  int32_t boundary_edges = 0;
  /// Edges with more than two faces, and faces that OpenMesh cannot add without pinching a vertex.
  int32_t nonmanifold_edges = 0;
  int32_t nonmanifold_faces = 0;
  /// Edges that both their faces traverse in the same direction.
  int32_t flipped_edges = 0;
  /// Faces with a repeated corner, or with an area of at most 1e-14 of the mesh's squared extent.
  int32_t zero_area_faces = 0;
  /// Vertices that no face uses.
  int32_t unused_vertices = 0;
  /// No edge is flipped, and every closed component encloses a positive volume (outward winding).
  bool winding_ok = true;
  /// Enclosed volume, summed over the components.
  double volume = 0.0;

  bool closed() const {
    return boundary_edges == 0 && nonmanifold_edges == 0 && nonmanifold_faces == 0;
  }
};

/// @throws std::invalid_argument for corner indices out of range.
void require_corners(const std::vector<Quad>& quads, size_t vertex_count);

/// Counts edges by their end points and walks around every vertex; non-manifold surfaces are added
/// face by face to OpenMesh.
/// @throws std::invalid_argument for corner indices out of range.
MeshCheck check_mesh(const std::vector<glm::vec3>& vertices, const std::vector<Quad>& quads);

}  // namespace snowbough::tree
