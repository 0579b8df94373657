#pragma once

#include <cstdint>
#include <vector>

#include "base/parallel_for.h"
#include "tree/skeleton/skeleton.h"
#include "tree/skeleton/tree_mesh.h"
#include "tree/surface/surface.h"
#include "tree/tubes/detail.h"

namespace snowbough::tree {

/// Turns the four-sided base into the surface that is looked at. The base stays the topology: each
/// of its quads is cut into quads, whose number along each edge both its neighbours share, so that
/// the surface stays closed, of one component a root, and without T-junctions.
///
/// Limbs get sides by their thickness (4 to DetailSettings::most_sides), follow a smooth curve
/// through their joints (LimbCurve), and are round. Where one leaves another the surface is that of
/// both tubes blended, with a fillet as wide as the thinner one's radius (blend_forks).
///
/// The parts of a base quad follow one another and keep its origin and branch level.
/// UVs are interpolated on the base quads' own, which keeps them apart from each other and every
/// face's area positive; so are weights.
///
/// @param mesh  the mesh of `surface`, at level 0, with its UVs and weights.
/// @param paths  limb_paths(skeleton), which the surface was built from.
/// @param max_influences most bones a vertex keeps, 1 to 4.
/// @throws Cancelled when execution's progress says stop; the mesh is of no use then.
void refine(TreeMesh& mesh, const Surface& surface, const Skeleton& skeleton,
            const std::vector<LimbPath>& paths, const SurfaceScale& scale, Detail detail,
            int max_influences, const base::Execution& execution = {});

}  // namespace snowbough::tree
