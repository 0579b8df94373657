#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// Snow that bridges the gaps between needles, as a mesh of its own over the surface.
struct Cushions {
  /// Each point hangs on the nearest snowy point of the surface: its number, and the way from there
  /// in metres.
  std::vector<int32_t> anchor;
  std::vector<glm::vec3> way;
  std::vector<std::array<int32_t, 4>> quads;
};

/// Whether a mesh is mostly of many thin pieces that snow of that depth bridges.
bool are_needles(const SurfaceMesh& mesh, float depth);

/// Closes and opens the snow, in the words of morphology: grown by a radius, it joins what is
/// nearer than twice that; shrunk by more, it loses what is thin, as the snow of a lone needle.
///
/// Sources: J. Serra, Image Analysis and Mathematical Morphology, 1982; S. F. F. Gibson,
/// Constrained Elastic Surface Nets, MICCAI 1998.
/// @param shown the surface's points. @param height how thick the snow is there. @param depth on
/// open ground.
Cushions find_cushions(const SurfaceMesh& mesh, const std::vector<glm::vec3>& shown,
                       const std::vector<float>& height, float depth);

}  // namespace snowbough::snow
