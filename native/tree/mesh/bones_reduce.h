#pragma once

#include <cstdint>
#include <vector>

#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

struct BoneBudget {
  /// Maximum number of bones; 0 = all.
  int32_t max_bones = 1000;
  /// Deepest level that keeps its bones; -1 = all.
  int32_t max_bone_level = -1;
};

struct ReducedBones {
  Bones bones;
  /// Per old bone: new index of the bone that replaces it: itself or its nearest kept ancestor.
  std::vector<int32_t> bone_map;
};

/// Keeps the bones of the lowest levels that fit the budget. A level that fits only in part loses
/// its bones from the tips, thinnest branches first. All ancestors of a kept bone are kept, and the
/// first bone of each root.
/// @throws std::invalid_argument for a negative max_bones.
ReducedBones reduce_bones(const Bones& bones, const BoneBudget& budget);

/// Maps every vertex's bones through `bone_map`, summing weights of equal bones.
void remap_weights(const std::vector<int32_t>& bone_map,
                   std::vector<std::array<int32_t, 4>>& bone_indices,
                   std::vector<std::array<float, 4>>& bone_weights);

}  // namespace snowbough::tree
