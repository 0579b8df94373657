#pragma once

#include <cstdint>
#include <vector>

#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// The parts of a mesh within which its surface goes on from face to face over an edge. At an edge
/// with more than two faces, such as the axle of a paddle wheel, a face goes on in the one opposite
/// to it, if any: the faces around the edge are ordered by angle, and the straightest pairs are
/// joined. Faces that coincide are one.
///
/// @return per triangle the lowest triangle of its part. O(triangles * log triangles).
std::vector<int32_t> face_parts(const SurfaceMesh& mesh);

}  // namespace snowbough::snow
