#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "tree/skeleton/tree_mesh.h"
#include "tree/tubes/fine_mesh.h"

namespace snowbough::tree {

/// Flattens creases that run across a limb beside its forks: where two of its faces that follow one
/// another along it meet at a sharper angle than an artist would leave, the ends of the edge
/// between them go towards the lines between the vertices before and after them, again and again,
/// until the angle is spread over the faces around. Creases between a limb and its child are none
/// of these.
///
/// @param origins  of the base's quads.
/// @param chains  per branch, limb_chains: limbs that continue one another are one.
/// @param farthest  per vertex: how far it may go in all, metres; 0 where it stays.
void soften_creases(const FineMesh& fine, std::span<const FaceOrigin> origins,
                    const std::vector<int32_t>& chains, std::span<const double> farthest,
                    std::vector<glm::dvec3>& points);

}  // namespace snowbough::tree
