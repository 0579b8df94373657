#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "render/snow/refine.h"
#include "render/sources.h"

namespace snowbough::render {

struct SnowPatches;

/// Smooth normals of every triangle corner, or the source's own: the directions in which its snow
/// grows.
std::vector<std::array<glm::vec3, 3>> growth_directions(const SnowSource& source);

/// Works out how far the surface that the normals tell of lies from the facets: `bend` of each
/// vertex, and the patches' `edge_bends`. What is shaded flat has none; over a hard edge it is the
/// mean of both faces'. A bend is of the second degree over a triangle of the source, so that along
/// a part of it from one vertex to another it is exactly
///
///   mix(bend of one, bend of the other, t) + t (1 - t) * the edge's bend.
///
/// Half of Phong tessellation, as shells of a bake have it (T. Boubekeur, M. Alexa, Phong
/// Tessellation, 2008).
void find_bends(const SnowSource& source, const RefinedMesh& refined,
                const std::vector<std::array<glm::vec3, 3>>& directions, SnowPatches& patches);

}  // namespace snowbough::render
