#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "tree/collars/fork_field.h"
#include "tree/tubes/fine_mesh.h"
#include "tree/tubes/limb_tubes.h"

namespace snowbough::tree {

/// The positions of the fine mesh's vertices on the limbs' round sections.
///
/// The collar of a hole follows the intersection of child and parent, raised by the fillet between
/// them (meet_limbs), and the parent's vertices around it move along (move_collars). The child
/// begins at the collar with straight sides. Where other limbs leave the parent no room for that,
/// collar and child's base stay closer to their place on the base mesh, and the child becomes round
/// within the fork's reach. Caps are flat.
///
/// @param forks  one per junction, from collect_forks. Collars of forks that do not blend stay
/// where
///   the base has them.
std::vector<glm::dvec3> limb_positions(const Surface& surface, const LimbTubes& tubes,
                                       const std::vector<Fork>& forks, const FineMesh& fine,
                                       int threads);

}  // namespace snowbough::tree
