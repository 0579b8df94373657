#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "tree/mesh/edges.h"
#include "tree/skeleton/tree_mesh.h"
#include "tree/tubes/cuts.h"

namespace snowbough::tree {

/// A vertex of the detailed mesh: a place on a base face, (0, 0) at its corner 0, (1, 0) at corner
/// 1, (1, 1) at corner 2.
struct FinePlace {
  int32_t face = -1;
  double u = 0.0, v = 0.0;
};

/// A refined mesh of quads without T-junctions.
struct FineMesh {
  /// The base's vertices come first, in their order.
  std::vector<FinePlace> vertices;
  /// The quads of each base quad are consecutive.
  std::vector<Quad> quads;
  /// Per quad: its base quad, and the position of its corners on it.
  std::vector<int32_t> face;
  std::vector<std::array<glm::dvec2, 4>> corners;
};

/// Cuts every base quad according to its edges. A vertex shared by several base quads has its place
/// on the first of them.
FineMesh cut_quads(const std::vector<Quad>& quads, size_t vertex_count, const Edges& edges,
                   const BaseCuts& cuts);

/// Per vertex, 1 if straighten moves it.
std::vector<uint8_t> between_others(const FineMesh& fine);

/// Moves vertices that belong to only one of their edge's faces, where limbs change their number of
/// sides, back onto the line between their two neighbours: the faces there are triangles with four
/// corners, and would otherwise fold.
/// @param faces  per face, 0 skips it.
void straighten(const FineMesh& fine, std::span<const uint8_t> faces,
                std::vector<glm::dvec3>& points);

}  // namespace snowbough::tree
