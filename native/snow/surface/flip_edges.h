#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// Turns edges within the receiver's faces until each is the shorter diagonal of its two triangles
/// where snow lies, so that triangles follow folds and hems.
///
/// Source: N. Dyn, D. Levin, S. Rippa, Data Dependent Triangulations for Piecewise Linear
/// Interpolation, IMA Journal of Numerical Analysis 10, 1990.
/// @param shown the points of the snow, one a point of the mesh.
void flip_edges(SurfaceMesh& mesh, const std::vector<glm::vec3>& shown);

}  // namespace snowbough::snow
