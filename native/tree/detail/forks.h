#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/parallel_for.h"
#include "tree/collars/fork_field.h"
#include "tree/surface/surface.h"
#include "tree/tubes/fine_mesh.h"

namespace snowbough::tree {

/// Moves the vertices near forks onto the blended surface of both limbs: the zero level of the
/// smooth minimum of the distances from their tubes, with a fillet as wide as the thinner one's
/// radius at its base. Between steps towards it they move along it like their neighbours, so that
/// faces keep their proportions and none folds over.
///
/// Afterwards pleats and intersections are unfolded (untangle), creases across limbs are softened
/// (soften_creases), and remaining intersections are undone (undo_moves).
///
/// A limb's tube ends at its base inside its parent; the fillet fades out along the limbs.
///
/// @param forks  one per junction, from collect_forks.
/// @param chains  per branch, from limb_chains.
/// @param points  of the fine mesh's vertices, on the limbs' own sections.
/// @throws Cancelled when execution's progress says stop.
///
/// Source of the smooth minimum: I. Quilez, "Smooth minimum", 2013 (polynomial, of limited range).
void blend_forks(const Surface& surface, const std::vector<Fork>& forks,
                 const std::vector<int32_t>& chains, const FineMesh& fine,
                 const base::Execution& execution, std::vector<glm::dvec3>& points);

}  // namespace snowbough::tree
