#pragma once

#include <vector>

#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/read/classify.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Copies the wood out of the file, in its order and axes: limbs, forking surfaces, and wood in
/// which no limb was found. Branch and place of the vertices stay empty.
/// @param branches  whose `piece` is still their part of the file.
/// @throws std::invalid_argument if the wood is rows of planes, which are no surface.
KeptSurface gather_kept(const ObjScene& scene, const Parts& parts,
                        const ClassifiedParts& classified, const std::vector<Branch>& branches);

/// Gives every vertex of the kept surface its branch, by the limb that was traced along its part of
/// the surface, and its place there: the nearest on that branch's centreline. Wood without a limb
/// follows the nearest branch: vertex by vertex, or as one if it is small (a card, a knot). Turns
/// tubes that are inside out, and drops normals that contradict the polygons, with a warning.
/// @param skeleton  complete, with the branches' points before simplification.
void attach_kept(Skeleton& skeleton);

}  // namespace snowbough::tree
