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

/// The wood of a file as branches without parents.
struct TracedBranches {
  TreeForm form = TreeForm::kMergedTubes;
  /// With name, level (-1 if names do not give it), points, radii and areas; `piece` is the part of
  /// the file (gather_wood makes it a piece).
  std::vector<Branch> branches;
  /// Per branch: either end may be its root.
  std::vector<char> reversible;
  /// Per branch: index into PartLabels::names or -1.
  std::vector<int32_t> label;
  /// Some branches already have parents and attach points, from a forking surface.
  bool welded = false;
  /// Names in the file, or the user, distinguish wood from leaves.
  bool named = false;
};

/// Collects tubes and rows of planes in file order. A branch is named after its group if the group
/// is one branch, and numbered within it otherwise.
TracedBranches trace_branches(const ObjScene& scene, const Parts& parts, const PartLabels& labels,
                              ClassifiedParts& classified);

/// Sets every branch's level from the names; -1 for all if the names do not give levels or parents
/// are already known.
/// @param levels the user's level names or "".
/// @param warnings receives messages for the user.
/// @throws std::invalid_argument as match_levels.
void assign_levels(TracedBranches& traced, const PartLabels& labels, TreeForm form,
                   const std::string& levels, std::vector<std::string>& warnings);

}  // namespace snowbough::tree
