#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/parallel_for.h"
#include "tree/detail/neighbours.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// What has moved at forks.
struct ForkFaces {
  const std::vector<Quad>& quads;
  const Neighbours& neighbours;
  /// The vertices that have moved and may move, ascending.
  std::vector<int32_t> moving;
  /// Per fork: the faces that have some of them as corners, ascending.
  std::vector<std::vector<int32_t>> faces;
};

/// Only takes back what has come to cross by moving.
/// @param before, points, execution  uncross.
void take_back(const ForkFaces& forks, const std::vector<glm::dvec3>& before,
               const base::Execution& execution, std::vector<glm::dvec3>& points);

/// Mends faces that cross at forks. Where moving made some cross that did not before, the vertices
/// around them go back, part of the way at a time, until none does. What crosses still, because it
/// did before, is put between its neighbours, round by round; where that does not help it stays.
///
/// @param before  all points as they were before they moved.
/// @param dirty  per fork, 0 where nothing crosses; empty: all are looked at.
/// @throws Cancelled when execution's progress says stop.
void uncross(const ForkFaces& forks, const std::vector<glm::dvec3>& before,
             const base::Execution& execution, std::vector<glm::dvec3>& points,
             std::vector<uint8_t> dirty = {});

}  // namespace snowbough::tree
