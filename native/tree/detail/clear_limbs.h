#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/parallel_for.h"
#include "tree/surface/limb_path.h"
#include "tree/surface/surface.h"
#include "tree/tubes/fine_mesh.h"

namespace snowbough::tree {

/// Mends faces that cross anywhere on the finished mesh but do not in the export.
///
/// Limbs that have nothing to do with each other may pass so closely that a curve, or the corners
/// of a limb with few sides, cuts the other one: the thinner one is bent out of the way, away from
/// the other's middle line. Those whose own tubes, round along their straight segments, cut each
/// other already, stay: they cross in the bought tree. Where a limb crosses itself, its parent or
/// its child, the faces around go back towards the four-sided base, which has been freed of that
/// (build_uncrossed_surface).
///
/// @param paths  limb_paths.
/// @param parents  per branch its parent, or -1.
/// @param chains  per branch, limb_chains.
/// @throws Cancelled when execution's progress says stop.
void clear_limbs(const Surface& surface, const std::vector<LimbPath>& paths,
                 const std::vector<int32_t>& parents, const std::vector<int32_t>& chains,
                 const FineMesh& fine, const base::Execution& execution,
                 std::vector<glm::dvec3>& points);

}  // namespace snowbough::tree
