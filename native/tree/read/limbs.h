#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tree/obj/obj_scene.h"
#include "tree/obj/parts.h"
#include "tree/read/classify.h"
#include "tree/read/part_names.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// The wood of a file as branches that know no parent yet.
struct TracedBranches {
  /// Name, level (-1 where no names tell it), points, radii and areas are filled; `piece` is the
  /// part of the file (gather_wood makes it a piece).
  std::vector<Branch> branches;
  /// Per branch: either end may be its root.
  std::vector<char> reversible;
  /// Per branch: index into PartLabels::names or -1.
  std::vector<int32_t> label;
  /// Some branches came with their parents and the places where they leave them, from a surface
  /// that forks.
  bool welded = false;
  /// Names in the file, or the user, say what is wood or leaves.
  bool named = false;
  /// Planes stood in the file in an order that means nothing and were put in order by their places.
  bool shuffled = false;
  /// Of these, planes that faced no other and belong to no branch.
  size_t lone_planes = 0;
};

/// Gathers tubes and rows of planes in the order of the file. Branches are named after their group
/// where a group is a branch, and numbered within it otherwise.
TracedBranches trace_branches(const ObjScene& scene, const Parts& parts, const PartLabels& labels,
                              ClassifiedParts& classified);

/// Sets every branch's level from the names, where they tell it; otherwise, and where parents are
/// known, all levels are -1.
/// @param levels the user's level names or "".
/// @param warnings receives what the user should know.
/// @throws std::invalid_argument as match_levels.
void assign_levels(TracedBranches& traced, const PartLabels& labels, TreeForm form,
                   const std::string& levels, std::vector<std::string>& warnings);

}  // namespace snowbough::tree
