#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "tree/detail/uncross.h"

namespace snowbough::tree {

/// The place on a smooth surface that a point near it belongs to.
using OntoSurface = std::function<glm::dvec3(int32_t vertex, const glm::dvec3& p)>;

/// Spreads out what lies in pleats or crosses: the mesh lies on a smooth surface, which does not
/// fold, so vertices around go between their neighbours and back to the surface, over more and more
/// rings around what is still folded, until nothing is. Vertices that all lie between their
/// neighbours leave no room for a pleat (W. T. Tutte, "How to Draw a Graph", Proceedings of the
/// London Mathematical Society 13, 1963). What crosses in the end, where faces are too long for the
/// surface's bends, is spread out without regard to it.
///
/// @param pull  per vertex: neighbours further away than this pull as if they were so near, metres;
///   0 for those that stay.
/// @throws Cancelled when execution's progress says stop.
/// @return per fork, 1 where faces cross still or were not looked at since they moved.
std::vector<uint8_t> untangle(const ForkFaces& forks, std::span<const double> pull,
                              const OntoSurface& onto, const base::Execution& execution,
                              std::vector<glm::dvec3>& points);

}  // namespace snowbough::tree
