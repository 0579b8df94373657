#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "tree/detail/uncross.h"

namespace snowbough::tree {

/// Projects a point near a smooth surface onto the surface.
using SurfaceProjection = std::function<glm::dvec3(int32_t vertex, const glm::dvec3& p)>;

/// Unfolds pleats and intersecting faces: the mesh lies on a smooth surface that does not fold, so
/// vertices around a fault move between their neighbours and are projected back, over more and more
/// rings of faces, until no fault is left. If all vertices lie between their neighbours there is no
/// pleat (W. T. Tutte, "How to Draw a Graph", Proceedings of the London Mathematical Society 13,
/// 1963). Faces that still intersect, being too long for the surface's curvature, are moved without
/// projection.
///
/// @param pull  per vertex: neighbours farther away than this, in metres, pull as if they were at
///   this distance; 0 fixes the vertex.
/// @throws Cancelled when execution's progress says stop.
void untangle(MovedCrossings& crossings, std::span<const double> pull,
              const SurfaceProjection& onto, const base::Execution& execution,
              std::vector<glm::dvec3>& points);

}  // namespace snowbough::tree
