#pragma once

#include "base/progress.h"
#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/read/part_names.h"

namespace snowbough::tree {

/// Puts tubes together whose faces all have vertices of their own, as exporters write them that
/// unindex: single faces of one label (and quads split in two) that meet along whole edges become
/// one part.
///
/// Branches that touch stay apart: only an edge that exactly two faces have in common joins them,
/// with bit-equal ends, and only parts of one or two faces take part. What does not become a tube
/// or a forked surface in this way stays as it is, so that leaves and planes are not touched.
///
/// @param labels of the parts; what is named as foliage is left alone.
/// @param progress receives 0..1.
/// @return the parts, numbered by their first face; those that were joined count as one.
Parts join_loose_faces(const ObjScene& scene, Parts parts, const PartLabels& labels,
                       const base::Progress& progress = {});

}  // namespace snowbough::tree
