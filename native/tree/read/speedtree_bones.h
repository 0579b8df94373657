#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// A bone of SpeedTree's raw XML: a piece of a limb, in the units and axes of that file.
struct SpeedTreeBone {
  int64_t id = 0;
  /// Id of the bone it grows from, -1 for a root.
  int64_t parent = -1;
  double radius = 0.0;
  glm::dvec3 start{0.0}, end{0.0};
  /// The node of the tree that it belongs to, such as "Trunk 10"; may be empty.
  std::string generator;
};

/// The <Bone> elements of a raw XML file. Localised versions write decimal commas.
/// @param name  of the file, in messages.
/// @throws std::invalid_argument with file and line for missing or malformed attributes, two bones
///   with one id, a parent that does not exist, or bones that are their own ancestors; and for a
///   file without bones.
std::vector<SpeedTreeBone> parse_speedtree_bones(std::string_view text, const std::string& name);

/// Reads them from a file.
/// @throws std::invalid_argument as above, std::runtime_error for a file that cannot be read.
std::vector<SpeedTreeBone> read_speedtree_bones(const std::string& path);

/// Joins bones to branches, parents first: at the end of a bone the straightest bone of the same
/// generator goes on, and the others begin branches. There is one root: further ones leave it at
/// their own place.
/// @return branches with name, level, parent, attach point, points, radii and areas.
std::vector<Branch> branches_of_bones(const std::vector<SpeedTreeBone>& bones);

/// Moves branches into the space of the mesh that they belong to: both files may have other units
/// (metres, centimetres, feet) and another axis that points up.
/// @param points  of the mesh's wood; at least one.
/// @param name  of the bones' file, in messages.
/// @throws std::invalid_argument if the bones lie inside the wood in no units and axes.
void fit_branches(const std::vector<glm::vec3>& points, const std::string& name,
                  std::vector<Branch>& branches);

}  // namespace snowbough::tree
