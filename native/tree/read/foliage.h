#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/parallel_for.h"
#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/read/classify.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Gathers the foliage parts as one mesh, one leaf a part, in the order and the axes of the file.
/// Materials are those the leaves use, by name only; leaf_branch and leaf_attach_point stay empty.
Foliage gather_foliage(const ObjScene& scene, const Parts& parts,
                       const ClassifiedParts& classified);

/// Hangs every leaf on a branch.
///
/// Leaves of one shape (same polygons over the same number of vertices) have the same vertex at
/// their base: the one that is nearest to wood in most of them. Exporters leave out the petioles,
/// so that the base hangs in the air, often nearer to a foreign twig than to its own. The petioles'
/// length is found as that by which all leaves of the shape, prolonged from their centre over their
/// base, come nearest to wood; each leaf then hangs where its prolonged base is nearest to a limb's
/// surface. (On an Arbaro aspen, whose leaves stand in the file twig by twig, this finds 99.9 % of
/// the twigs; the nearest vertex 55 %.) Of a shape that is rare, or has no such vertex, each leaf's
/// own vertex nearest to wood counts.
///
/// @param branches at least one; before any simplification.
void attach_leaves(const std::vector<Branch>& branches, Foliage& foliage,
                   const base::Execution& execution = {});

}  // namespace snowbough::tree
