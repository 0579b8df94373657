#pragma once

#include <cstddef>
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
/// an edge. No value for other components.
std::optional<CrossSection> read_cross_section(const ObjScene& scene, const Parts& parts,
                                               int32_t part);

/// The planes of one branch, in file order. Single triangles that share two positions are paired to
/// planes.
/// @param unread receives the parts that are not planes.
std::vector<CrossSection> read_cross_sections(const ObjScene& scene, const Parts& parts,
                                              std::span<const int32_t> branch_parts,
                                              std::vector<int32_t>& unread);

/// Fraction of the consecutive pairs of planes that are perpendicular to the line between their
/// centres; planes without area and zero distances count as perpendicular.
double row_share(std::span<const CrossSection> sections);

/// Turns of the line through the planes' centres in file order.
struct Turns {
  size_t all = 0;
  /// Turns by more than a right angle.
  size_t back = 0;
};

/// Adds the turns of a group's planes.
void count_turns(std::span<const CrossSection> sections, Turns& turns);

/// Splits consecutive planes into rows, one per limb: a new row begins where the distance is much
/// larger than those before and after, where the line turns sideways, or where the limb suddenly
/// thickens.
/// @return the first plane of each row.
std::vector<size_t> chain_cross_sections(std::span<const CrossSection> sections);

/// A limb through planes in their order; the first is at the root.
Limb limb_from_cross_sections(std::span<const CrossSection> sections);

}  // namespace snowbough::tree
