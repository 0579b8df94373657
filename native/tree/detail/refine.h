#pragma once

#include <vector>

#include "base/parallel_for.h"
#include "tree/skeleton/tree_mesh.h"
#include "tree/surface/limb_path.h"
#include "tree/surface/surface.h"
#include "tree/tubes/detail.h"

namespace snowbough::tree {

/// Refines the four-sided base into the final surface. The base keeps the topology: each of its
/// quads is cut into quads, and both neighbours of an edge share its number of pieces, so that the
/// surface stays closed, with one component per root and without T-junctions.
///
/// The sides of a limb depend on its thickness (4 to DetailSettings::most_sides). Limbs follow a
/// smooth curve through their joints (LimbCurve) and are round. At a fork the surface is the blend
/// of both tubes, with a fillet as wide as the thinner one's radius (blend_forks).
///
/// The parts of a base quad are consecutive and keep its origin and branch level. UVs are
/// interpolated within the base quads, which keeps them from overlapping and every face's area
/// positive. Weights are interpolated too.
///
/// @param mesh  the mesh of `surface`, the base, with its UVs and weights.
/// @param paths  limb_paths(skeleton), which the surface was built from.
/// @param max_influences most bones a vertex keeps, 1 to 4.
/// @throws Cancelled when execution's progress says stop; the mesh is then unusable.
void refine(TreeMesh& mesh, const Surface& surface, const std::vector<LimbPath>& paths,
            const LengthLimits& scale, Detail detail, int max_influences,
            const base::Execution& execution = {});

}  // namespace snowbough::tree
