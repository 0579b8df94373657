#pragma once

#include <vector>

#include "base/parallel_for.h"
#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/read/classify.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Collects the foliage parts as one mesh, one leaf per part, in the order and axes of the file.
/// Materials are those in use, by name only; leaf_branch and leaf_attach_point stay empty.
Foliage gather_foliage(const ObjScene& scene, const Parts& parts,
                       const ClassifiedParts& classified);

/// Attaches every leaf to a branch.
///
/// Leaves of one shape (same polygons over the same number of vertices) have the same base vertex:
/// the one that is nearest to wood in most of them. Exporters omit petioles, so that the base hangs
/// in the air, often nearer to another twig than to its own. The petioles' length is estimated as
/// the one by which all leaves of the shape, extended from their centre beyond their base, come
/// nearest to wood; each leaf is then attached where its extended base is nearest to a limb's
/// surface. (On an Arbaro aspen, whose leaves are sorted by twig in the file, this finds 99.9 % of
/// the twigs; the nearest vertex 55 %.) For a rare shape, or one without such a vertex, each leaf's
/// own vertex nearest to wood counts.
///
/// @param branches at least one; before any simplification.
void attach_leaves(const std::vector<Branch>& branches, Foliage& foliage,
                   const base::Execution& execution = {});

}  // namespace snowbough::tree
