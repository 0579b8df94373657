#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/parallel_for.h"
#include "tree/rims/fork_field.h"
#include "tree/surface/surface.h"
#include "tree/tubes/fine_mesh.h"

namespace snowbough::tree {

/// Moves the vertices near forks onto the surface on which both limbs flow into each other: the
/// zero level of the smooth minimum of the distances from their tubes, with a fillet as wide as the
/// thinner one's radius at its base. Between steps towards it they move along it as their
/// neighbours have moved, so that faces stay as even as they were and none folds over.
///
/// What lies in pleats or crosses then is spread out (untangle), creases across limbs are softened
/// (soften_creases), and what still crosses is taken back or smoothed (uncross).
///
/// A limb's tube ends at its base inside its parent; the fillet fades out along the limbs, so that
/// further away they have their own surface.
///
/// @param forks  one a junction, collect_forks.
/// @param chains  per branch, limb_chains.
/// @param points  of the fine mesh's vertices, on the limbs' own sections.
/// @throws Cancelled when execution's progress says stop.
///
/// Source of the smooth minimum: I. Quilez, "Smooth minimum", 2013 (polynomial, of limited reach).
void blend_forks(const Surface& surface, const std::vector<Fork>& forks,
                 const std::vector<int32_t>& chains, const FineMesh& fine,
                 const base::Execution& execution, std::vector<glm::dvec3>& points);

}  // namespace snowbough::tree
