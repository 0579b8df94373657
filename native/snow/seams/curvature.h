#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// How much lies under a height where the surface is curved: a layer of the height h, measured
/// along the normal, holds
///
///   x h + y h^2 + z h^3
///
/// cubic metres per square metre of the mesh. On a smooth surface x = 1, y is the mean curvature
/// and z a third of the Gaussian one, both positive where it is convex: Steiner's formula for
/// parallel surfaces (J. Steiner, Über parallele Flächen, 1840).
using LayerTerms = glm::vec3;

/// By number of `shading` (3 a triangle, negative where a triangle is flat): the unit normal that
/// the corners of that number share, the mean of their triangles' weighted by their angles. Empty
/// where nothing is smooth.
std::vector<glm::vec3> shading_normals(const std::vector<int32_t>& triangles,
                                       const std::vector<int32_t>& shading,
                                       const std::vector<glm::vec3>& positions);

/// The terms at every triangle corner, 3 a triangle, for displacement along interpolated normals,
/// which are `normals`, see shading_normals. A corner with a negative number has its triangle's own
/// normal and the terms (1, 0, 0). A triangle's terms are those of the prism that its displaced
/// corners span, which takes the mesh for what it is, however coarse; corners that share a normal
/// share the mean of their triangles, by area. Empty where nothing is smooth.
std::vector<LayerTerms> layer_terms(const std::vector<int32_t>& triangles,
                                    const std::vector<int32_t>& shading,
                                    const std::vector<glm::vec3>& normals,
                                    const std::vector<glm::vec3>& positions);

/// The same, with the normals found.
inline std::vector<LayerTerms> layer_terms(const std::vector<int32_t>& triangles,
                                           const std::vector<int32_t>& shading,
                                           const std::vector<glm::vec3>& positions) {
  return layer_terms(triangles, shading, shading_normals(triangles, shading, positions), positions);
}

/// The height in metres at which a layer holds `held` (m3/m2). Negative on the back of the surface,
/// which curves the other way round. In hollows the height ends before the layer folds over itself,
/// and at a quarter more than what is held: narrow folds would throw up ridges.
float layer_height(float held, LayerTerms terms);

/// Turns what texels hold into heights, in place. `terms`: see layer_terms; where empty the map
/// stays as it is. `threads` share the work.
void show_layers(const TexelTable& table, const std::vector<LayerTerms>& terms,
                 std::vector<float>& map, int32_t threads);

}  // namespace snowbough::snow
