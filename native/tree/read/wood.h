#pragma once

#include <vector>

#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/read/classify.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Gathers the polygons of the parts that branches come from, as triangles, in the axes of the
/// file, with their texture coordinates and materials (by name only). Within a piece equal
/// positions become one vertex, so that a tube that was split along its texture seam hangs
/// together.
///
/// Rows of planes have a material but no triangles: a plane across a limb is no part of its
/// surface. Nor are triangles kept where they would tell nothing: every piece is of one material,
/// and the file has no texture coordinates.
///
/// @param branches as trace_branches leaves them: `piece` is a part and becomes the index of a
/// piece.
///   Pieces stand in the order of their parts.
OriginalWood gather_wood(const ObjScene& scene, const Parts& parts,
                         const ClassifiedParts& classified, std::vector<Branch>& branches);

}  // namespace snowbough::tree
