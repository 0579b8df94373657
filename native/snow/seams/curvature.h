#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Volume under a height on a curved surface: a layer of height h, measured along the normal, holds
///
///   x h + y h^2 + z h^3
///
/// cubic metres per square metre of the mesh. On a smooth surface x = 1, y is the mean curvature
/// and z a third of the Gaussian curvature, both positive where it is convex: Steiner's formula for
/// parallel surfaces (J. Steiner, Über parallele Flächen, 1840).
using LayerTerms = glm::vec3;

/// By number of `shading` (3 per triangle, negative for flat triangles): the unit normal of the
/// corners with that number, the mean of their triangles' normals weighted by angle. Empty if
/// nothing is smooth.
std::vector<glm::vec3> shading_normals(const std::vector<int32_t>& triangles,
                                       const std::vector<int32_t>& shading,
                                       const std::vector<glm::vec3>& positions);

/// The terms at every triangle corner, 3 per triangle, for displacement along interpolated normals;
/// `normals`: see shading_normals. A corner with a negative number has its triangle's normal and
/// the terms (1, 0, 0). A triangle's terms are those of the prism that its displaced corners span,
/// so that coarse meshes are exact too; corners that share a normal share the mean of their
/// triangles, weighted by area. Empty if nothing is smooth.
std::vector<LayerTerms> layer_terms(const std::vector<int32_t>& triangles,
                                    const std::vector<int32_t>& shading,
                                    const std::vector<glm::vec3>& normals,
                                    const std::vector<glm::vec3>& positions);

/// The same, computing the normals.
inline std::vector<LayerTerms> layer_terms(const std::vector<int32_t>& triangles,
                                           const std::vector<int32_t>& shading,
                                           const std::vector<glm::vec3>& positions) {
  return layer_terms(triangles, shading, shading_normals(triangles, shading, positions), positions);
}

/// Converts texels' volumes to heights, in place. `terms`: see layer_terms; if empty, the map stays
/// unchanged. `threads` share the work.
void show_layers(const TexelTable& table, const std::vector<LayerTerms>& terms,
                 std::vector<float>& map, int32_t threads);

}  // namespace snowbough::snow
