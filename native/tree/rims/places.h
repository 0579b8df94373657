#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "tree/rims/fork_field.h"
#include "tree/tubes/fine_mesh.h"
#include "tree/tubes/limb_tubes.h"

namespace snowbough::tree {

/// Where the vertices of the fine mesh lie on the limbs' round sections.
///
/// The rim of a hole follows the line in which child and parent meet, lifted by the fillet between
/// them (meet_limbs), and what lies around it on the parent moves along (move_rims). The child
/// begins at the rim with straight sides. Where the parent has no room for that - others leave it
/// there too - rim and child's base stay nearer to where the base has them, and the child becomes
/// round within the fork's reach. Caps are flat.
///
/// @param forks  one a junction, collect_forks.
///   Rims of those that do not blend stay where the base has them.
std::vector<glm::dvec3> limb_positions(const Surface& surface, const LimbTubes& tubes,
                                       const std::vector<Fork>& forks, const FineMesh& fine,
                                       int threads);

}  // namespace snowbough::tree
