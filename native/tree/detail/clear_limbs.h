#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/parallel_for.h"
#include "tree/surface/limb_path.h"
#include "tree/surface/surface.h"
#include "tree/tubes/fine_mesh.h"

namespace snowbough::tree {

/// Repairs faces that intersect anywhere on the finished mesh but not in the export.
///
/// Two unrelated limbs may pass so closely that a curve, or the corners of a limb with few sides,
/// cuts the other one: the thinner limb is bent away from the other's centreline. Limbs whose round
/// tubes along their straight segments already intersect stay, since they intersect in the export.
/// Where a limb intersects itself, its parent or its child, the faces around move back towards the
/// four-sided base, which is free of intersections (build_uncrossed_surface).
/// @param paths  limb_paths.
/// @param parents  per branch: its parent, or -1.
/// @param chains  per branch, limb_chains.
/// @throws Cancelled when execution's progress says stop.
void clear_limbs(const Surface& surface, const std::vector<LimbPath>& paths,
                 const std::vector<int32_t>& parents, const std::vector<int32_t>& chains,
                 const FineMesh& fine, const base::Execution& execution,
                 std::vector<glm::dvec3>& points);

}  // namespace snowbough::tree
