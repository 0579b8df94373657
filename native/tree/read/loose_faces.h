#pragma once

#include "base/progress.h"
#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/read/part_names.h"

namespace snowbough::tree {

/// Joins tubes whose faces have no shared vertices, as some exporters write them: single faces of
/// one label (and quads split in two) that meet along whole edges become one part.
///
/// Branches that touch stay separate: only an edge shared by exactly two faces, with bit-equal
/// ends, joins them, and only parts of one or two faces take part. Faces that do not form a tube or
/// a forking surface in this way stay unchanged, so that leaves and planes are not affected.
///
/// @param labels of the parts; parts named as foliage are ignored.
/// @param progress receives 0..1.
/// @return the parts, numbered by their first face; joined parts count as one.
Parts join_loose_faces(const ObjScene& scene, Parts parts, const PartLabels& labels,
                       const base::Progress& progress = {});

}  // namespace snowbough::tree
