#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "tree/obj/obj_scene.h"
#include "tree/rings/rings.h"

namespace snowbough::tree {

/// Finds the rings of a tube whose number of corners changes on the way, in any order of its
/// vertices and faces: a surface without holes that is open at one end, by a loop of 3 to 16 edges,
/// and closed at the other, and at least three times as long as it is thick. The open end is the
/// root.
///
/// The rings are the layers that a walk from the open end meets, where each of them is one closed
/// ring of edges; otherwise, where belts of triangles run aslant, level sets of the distance from
/// the open end (see welded.h).
///
/// @param faces, vertices the component's faces and its vertices (ascending).
std::optional<Limb> trace_uneven_tube(const ObjScene& scene, std::span<const int32_t> faces,
                                      std::span<const int32_t> vertices);

}  // namespace snowbough::tree
