#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "snow/surface/cushions.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// Faces of three or four corners.
struct SurfaceFaces {
  /// Face f has the corners begin[f] to begin[f + 1] - 1.
  std::vector<int32_t> begin{0};
  std::vector<int32_t> corner;
  /// Texture coordinates of the corners, in the receiver's UV map.
  std::vector<glm::vec2> uv;
};

/// The faces of a mesh, then those of its cushions, whose points follow those of the mesh.
SurfaceFaces surface_faces(const SurfaceMesh& mesh, const Cushions& cushions);

}  // namespace snowbough::snow
