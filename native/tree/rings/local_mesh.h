#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <utility>
#include <vector>

#include "tree/obj/obj_scene.h"

namespace snowbough::tree {

/// The component with vertices renumbered from 0 and faces as a flat list.
struct LocalMesh {
  std::vector<glm::vec3> positions;
  std::vector<int32_t> face_begin{0};
  std::vector<int32_t> corners;

  int32_t face_count() const { return static_cast<int32_t>(face_begin.size()) - 1; }
  std::span<const int32_t> face(int32_t f) const {
    return {corners.data() + face_begin[f], corners.data() + face_begin[f + 1]};
  }
};

/// Copies one component out of the scene.
/// @param faces, vertices the component's faces and its vertices (ascending).
LocalMesh extract_component(const ObjScene& scene, std::span<const int32_t> faces,
                            std::span<const int32_t> vertices);

/// Merges vertices at bit-equal positions; faces lose coincident corners.
/// @param numbers  receives the new number of each vertex; null = not needed.
LocalMesh weld_equal_positions(const LocalMesh& mesh, std::vector<int32_t>* numbers = nullptr);

/// The faces' edges as pairs of vertices, the smaller first, once for every face; sorted.
std::vector<std::pair<int32_t, int32_t>> polygon_edges(const LocalMesh& mesh);

/// Adjacency for a walk over the component.
struct Topology {
  std::vector<int32_t> vertex_face_begin;
  std::vector<int32_t> vertex_faces;
  /// Connected sets of boundary edges' vertices, each ascending, ordered by their smallest vertex.
  std::vector<std::vector<int32_t>> boundary_loops;
};

Topology build_topology(const LocalMesh& mesh);

/// Sets of vertices, each ascending.
using Layers = std::vector<std::vector<int32_t>>;

/// Each layer contains the vertices that share a face with the layer before and are new.
/// @param most_uneven stops the walk, and returns no layers, when one layer has more than this many
///   times the vertices of another (ignoring the last, and the first if it is a single vertex). 0:
///   never.
Layers walk_layers(const LocalMesh& mesh, const Topology& topology, std::vector<int32_t> start,
                   size_t most_uneven = 0);

}  // namespace snowbough::tree
