#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/rings/rings.h"

namespace snowbough::tree {

/// A plane across a limb: one polygon, or two triangles side by side.
struct CrossSection {
  /// Corners in cyclic order.
  std::vector<glm::vec3> corners;
};

/// Reads a component as a plane: one polygon of four or more corners, or two triangles that share
/// an edge. Nothing for any other component.
std::optional<CrossSection> read_cross_section(const ObjScene& scene, const Parts& parts,
                                               int32_t part);

/// The planes of one branch, in the order of the file. Single triangles are joined in pairs to
/// planes when they share two positions.
/// @param unread receives the parts that are no planes.
std::vector<CrossSection> read_cross_sections(const ObjScene& scene, const Parts& parts,
                                              std::span<const int32_t> branch_parts,
                                              std::vector<int32_t>& unread);

/// Share of the consecutive pairs of planes that stand across the line between their centres;
/// planes and distances of no size count as such.
double row_share(std::span<const CrossSection> sections);

/// Cuts planes that follow one another into rows, one a limb: a new row begins where the distance
/// jumps beyond those before and after it, where the line leaves sideways, or where the limb
/// suddenly thickens.
/// @return the first plane of each row.
std::vector<size_t> chain_cross_sections(std::span<const CrossSection> sections);

/// A limb through planes in their order: the first is the root's.
Limb limb_from_cross_sections(std::span<const CrossSection> sections);

}  // namespace snowbough::tree
