#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// Snow that bridges the gaps between needles: a separate mesh above the surface.
struct Cushions {
  /// Each point is anchored to the nearest snow-covered point of the surface: the index of that
  /// point, and the offset from it in metres.
  std::vector<int32_t> anchor;
  std::vector<glm::vec3> offset;
  std::vector<std::array<int32_t, 4>> quads;
  /// Thickness of the snow at the anchors in the last frame, in metres. find_cushions leaves it
  /// out.
  std::vector<float> height;
};

/// True if a mesh consists mostly of many thin pieces whose gaps snow of this depth bridges.
bool are_needles(const SurfaceMesh& mesh, float depth);

/// Applies a morphological closing and opening to the snow. It dilates the snow by a radius, which
/// joins snow that is less than two radii apart. Then it erodes the snow by more than that radius,
/// which removes thin snow, such as the snow on a single needle.
///
/// Sources: J. Serra, Image Analysis and Mathematical Morphology, 1982; S. F. F. Gibson,
/// Constrained Elastic Surface Nets, MICCAI 1998.
/// @param shown points of the snow surface, in metres.
/// @param height thickness of the snow at each point, in metres.
/// @param depth snow depth on open ground, in metres.
/// @param most_points greatest number of points. Cells and radii grow until the cushions fit; there
/// are none if they do not fit with a radius of a depth.
Cushions find_cushions(const SurfaceMesh& mesh, const std::vector<glm::vec3>& shown,
                       const std::vector<float>& height, float depth, int32_t most_points);

}  // namespace snowbough::snow
