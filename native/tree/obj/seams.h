#pragma once

#include "tree/obj/obj_scene.h"

namespace snowbough::tree {

/// Closes the seams at which exporters split a surface where normals or texture coordinates differ:
/// corners on both sides get one vertex, the one of the smallest index.
///
/// Two open edges of one group belong together if they lie at the same place in opposite directions
/// and no third one lies there. Edges with the same texture coordinates come first: they
/// distinguish the collapsed rings of a tube, whose faces have no area and whose edges lie at one
/// place. Without such coordinates, faces without area stay alone. Open ends of tubes that touch
/// another branch keep their vertices.
void close_seams(ObjScene& scene);

/// Gives all corners at bit-equal positions one vertex, the one of the smallest index. Joins
/// branches that touch at a vertex: only for files that cannot be read otherwise.
void weld_positions(ObjScene& scene);

}  // namespace snowbough::tree
