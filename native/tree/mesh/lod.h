#pragma once

#include "base/parallel_for.h"
#include "tree/skeleton/tree_mesh.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Subdivides the four-sided base: `levels` times, every quad becomes four and the limbs' sides
/// double. The parts of a base quad are consecutive, child 0 at its corner 0, and keep its origin,
/// branch level and corner order. Weights and UVs are interpolated.
///
/// New vertices, and once the base's own, are projected onto the limbs' radius: the mean over all
/// limb sections of the vertex of the nearest point on the section's infinite line plus sqrt(area /
/// pi) along the offset (clamping to the section's ends would shrink the limb at every bend). A
/// vertex between two sections of a limb belongs to both, one on the rim of a child's hole to
/// parent and child. Rims are then smoothed.
///
/// @param mesh the mesh of `surface`, at level 0.
/// @param max_influences maximum number of bones per vertex, 1 to 4.
/// @throws Cancelled when execution's progress says stop; the mesh is then unusable.
///
/// Source: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, eq. 3.4.2.
void subdivide(TreeMesh& mesh, const Surface& surface, int levels, int max_influences,
               const base::Execution& execution = {});

}  // namespace snowbough::tree
