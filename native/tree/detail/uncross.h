#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/parallel_for.h"
#include "tree/mesh/neighbours.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// The movable vertices at forks and their faces.
struct ForkFaces {
  const std::vector<Quad>& quads;
  const Neighbours& neighbours;
  /// The vertices that have moved and may still move, ascending.
  std::vector<int32_t> moving;
  /// Per fork: the faces with a moving corner, ascending.
  std::vector<std::vector<int32_t>> faces;

  /// Marks the forks with a face one of whose corners has moved: has_moved(vertex).
  template <typename HasMoved>
  void find_dirty(const HasMoved& has_moved, std::vector<uint8_t>& dirty) const {
    for (size_t j = 0; j < dirty.size(); ++j) {
      dirty[j] = std::any_of(faces[j].begin(), faces[j].end(), [&](int32_t face) {
        return std::any_of(quads[face].begin(), quads[face].end(), has_moved);
      });
    }
  }
};

/// Undoes only the moves that caused intersections.
/// @param before, points, execution  as for uncross.
void undo_moves(const ForkFaces& forks, const std::vector<glm::dvec3>& before,
                const base::Execution& execution, std::vector<glm::dvec3>& points);

/// Repairs intersecting faces at forks. Where moving made faces intersect, the vertices around them
/// move back step by step until none do. Faces that intersected before are moved between their
/// neighbours, round by round; if that fails they stay.
///
/// @param before  all points before the move.
/// @param dirty  per fork, 0 if nothing intersects; empty: check all.
/// @throws Cancelled when execution's progress says stop.
void uncross(const ForkFaces& forks, const std::vector<glm::dvec3>& before,
             const base::Execution& execution, std::vector<glm::dvec3>& points,
             std::vector<uint8_t> dirty = {});

}  // namespace snowbough::tree
