#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "tree/skeleton/tree_mesh.h"
#include "tree/tubes/fine_mesh.h"

namespace snowbough::tree {

/// Flattens creases that run across a limb beside its forks: where two consecutive faces along the
/// limb meet at a sharper angle than an artist would leave, the ends of their common edge move
/// towards the lines between the vertices before and after them, repeatedly, until the angle is
/// spread over the faces around. Creases between a limb and its child are left alone.
///
/// @param origins  of the base's quads.
/// @param chains  per branch, from limb_chains: limbs that continue one another count as one.
/// @param farthest  per vertex: maximum total displacement in metres; 0 fixes it.
void soften_creases(const FineMesh& fine, std::span<const FaceOrigin> origins,
                    const std::vector<int32_t>& chains, std::span<const double> farthest,
                    std::vector<glm::dvec3>& points);

}  // namespace snowbough::tree
