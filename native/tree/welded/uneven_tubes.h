#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "tree/obj/obj_scene.h"
#include "tree/rings/rings.h"

namespace snowbough::tree {

/// Finds the rings of a tube whose number of corners changes along it, for any order of vertices
/// and faces. The tube has no other holes than its ends and is at least three times as long as
/// thick. It is open at both ends, or at one (a loop of 3 to 16 edges). The wider open end is the
/// root.
///
/// If the layers of a walk from the root are each one closed ring of edges, they are the rings;
/// otherwise (belts of oblique triangles) level sets of the distance from the root are used (see
/// welded.h).
///
/// @param faces, vertices the component's faces and its vertices (ascending).
std::optional<Limb> trace_uneven_tube(const ObjScene& scene, std::span<const int32_t> faces,
                                      std::span<const int32_t> vertices);

}  // namespace snowbough::tree
