#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "tree/obj/obj_scene.h"
#include "tree/rings/rings.h"

namespace snowbough::tree {

/// Finds the rings of a tube whose number of corners changes along it, for any order of vertices
/// and faces. The tube has no holes, is open at one end (a loop of 3 to 16 edges) and closed at the
/// other, and is at least three times as long as thick. The open end is the root.
///
/// If the layers of a walk from the open end are each one closed ring of edges, they are the rings;
/// otherwise (belts of oblique triangles) level sets of the distance from the open end are used
/// (see welded.h).
///
/// @param faces, vertices the component's faces and its vertices (ascending).
std::optional<Limb> trace_uneven_tube(const ObjScene& scene, std::span<const int32_t> faces,
                                      std::span<const int32_t> vertices);

}  // namespace snowbough::tree
