#pragma once

#include <cstdint>
#include <vector>

#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

struct BoneBudget {
  /// Most bones to keep; 0 = all.
  int32_t max_bones = 1000;
  /// Deepest level that keeps its bones; -1 = all.
  int32_t max_bone_level = -1;
};

struct ReducedBones {
  Bones bones;
  /// Per old bone: the new index of the bone that does its work, itself or the nearest one kept
  /// among its ancestors.
  std::vector<int32_t> bone_map;
};

/// Keeps the bones of the shallowest levels that fit the budget; the last level that fits only in
/// part gives up its bones from the tips, thinnest branches first. A kept bone's ancestors are all
/// kept; the first bone of each root always is.
/// @throws std::invalid_argument for a negative max_bones.
ReducedBones reduce_bones(const Bones& bones, const BoneBudget& budget);

/// Replaces every vertex's bones through `bone_map`, adding up the weights that come together.
void remap_weights(const std::vector<int32_t>& bone_map,
                   std::vector<std::array<int32_t, 4>>& bone_indices,
                   std::vector<std::array<float, 4>>& bone_weights);

}  // namespace snowbough::tree
