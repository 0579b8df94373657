#pragma once

#include <vector>

#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/read/classify.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Collects the polygons of the branches' parts, as triangles, in the axes of the file, with their
/// texture coordinates and materials (by name only). Equal positions within a piece become one
/// vertex, so that a tube split along its texture seam is connected.
///
/// Rows of planes have a material but no triangles, since planes across a limb are not its surface.
/// Triangles are also omitted if they carry no information: every piece has one material, and the
/// file has no texture coordinates.
///
/// @param branches as from trace_branches: `piece` is a part and becomes the index of a piece.
///   Pieces are in the order of their parts.
OriginalWood gather_wood(const ObjScene& scene, const Parts& parts,
                         const ClassifiedParts& classified, std::vector<Branch>& branches);

}  // namespace snowbough::tree
