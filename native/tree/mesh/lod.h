#pragma once

#include "base/parallel_for.h"
#include "tree/skeleton/tree_mesh.h"
#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Turns the four-sided base into a finer mesh: `levels` times, every quad becomes four and the
/// limbs' sides double. Each base quad's parts follow one another, child 0 at its corner 0, and
/// keep its origin, branch level and corner order. Weights and UVs are interpolated.
///
/// New vertices, and once the base's own, are put on the limbs' radius: the mean of their positions
/// relative to each limb section that they belong to, each the nearest point on the section's
/// infinite line plus sqrt(area / pi) along the offset (clamping to the section's ends would shrink
/// the limb at every bend). A vertex between two sections of a limb belongs to both, one on the rim
/// of a child's hole to parent and child. Rims are then smoothed.
///
/// @param mesh the mesh of `surface`, at level 0.
/// @param max_influences most bones a vertex keeps, 1 to 4.
/// @throws Cancelled when execution's progress says stop; the mesh is of no use then.
///
/// Source: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, eq. 3.4.2.
void subdivide(TreeMesh& mesh, const Surface& surface, int levels, int max_influences,
               const base::Execution& execution = {});

}  // namespace snowbough::tree
