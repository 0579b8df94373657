#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "base/parallel_for.h"
#include "tree/mesh/neighbours.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// Movable vertices and their faces.
struct MovedFaces {
  const std::vector<Quad>& quads;
  const Neighbours& neighbours;
  /// The vertices that have moved and may still move, and the faces with such a corner; ascending.
  std::vector<int32_t> moving, faces;
  /// Per quad: its chain of limbs. Per chain: its parent, or -1. Only intersections within a chain
  /// and between parent and child count.
  std::vector<int32_t> chains, parents;
};

/// The related pairs of intersecting faces while vertices move.
class MovedCrossings {
 public:
  using Pairs = std::vector<std::pair<int32_t, int32_t>>;

  explicit MovedCrossings(const MovedFaces& moved) : moved(moved) {}

  /// The pairs now, ascending. Searches only pairs of which a face has moved since the last call.
  const Pairs& find(const std::vector<glm::dvec3>& points, int threads);

  const MovedFaces& moved;

 private:
  std::vector<glm::dvec3> before_;
  Pairs pairs_;
};

/// Undoes moves that caused intersections: the vertices around intersecting faces move back step by
/// step until none intersect.
/// @param before  all points before the move.
/// @throws Cancelled when execution's progress says stop.
void undo_moves(MovedCrossings& crossings, const std::vector<glm::dvec3>& before,
                const base::Execution& execution, std::vector<glm::dvec3>& points);

}  // namespace snowbough::tree
