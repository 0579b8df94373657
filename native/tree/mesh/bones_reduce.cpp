#include "tree/mesh/bones_reduce.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace snowbough::tree {
namespace {

/// Bones by decreasing importance: by level, then by thickness; no bone comes before its parent.
std::vector<int32_t> by_importance(const Bones& bones) {
  const size_t count = bones.heads.size();
  // Clamped to the parent's thickness and level: sorting then keeps ancestors first.
  std::vector<float> rank(bones.head_radii);
  std::vector<int32_t> level(bones.levels);
  for (size_t i = 0; i < count; ++i) {
    const int32_t parent = bones.parents[i];
    if (parent >= 0) {
      level[i] = std::max(level[i], level[parent]);
      if (level[i] == level[parent]) {
        rank[i] = std::min(rank[i], rank[parent]);
      }
    }
  }
  std::vector<int32_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int32_t a, int32_t b) {
    const bool root_a = bones.parents[a] < 0, root_b = bones.parents[b] < 0;
    if (root_a != root_b) {
      return root_a;
    }
    return level[a] != level[b] ? level[a] < level[b] : rank[a] > rank[b];
  });
  return order;
}

}  // namespace

ReducedBones reduce_bones(const Bones& bones, const BoneBudget& budget) {
  if (budget.max_bones < 0) {
    throw std::invalid_argument("max_bones must be 0 (all) or more, not " +
                                std::to_string(budget.max_bones));
  }
  const size_t count = bones.heads.size();
  const size_t most = budget.max_bones == 0 ? count : static_cast<size_t>(budget.max_bones);
  std::vector<uint8_t> keep(count, 0);
  size_t kept = 0;
  for (int32_t bone : by_importance(bones)) {
    const int32_t parent = bones.parents[bone];
    const bool allowed = budget.max_bone_level < 0 || bones.levels[bone] <= budget.max_bone_level;
    if (parent < 0 || (allowed && kept < most && keep[parent])) {
      keep[bone] = 1;
      ++kept;
    }
  }

  ReducedBones reduced;
  reduced.bone_map.resize(count);
  for (size_t i = 0; i < count; ++i) {
    const int32_t parent = bones.parents[i] < 0 ? -1 : reduced.bone_map[bones.parents[i]];
    if (!keep[i]) {
      reduced.bone_map[i] = parent;
      continue;
    }
    reduced.bone_map[i] = static_cast<int32_t>(reduced.bones.heads.size());
    reduced.bones.heads.push_back(bones.heads[i]);
    reduced.bones.tails.push_back(bones.tails[i]);
    reduced.bones.parents.push_back(parent);
    reduced.bones.names.push_back(bones.names[i]);
    reduced.bones.branches.push_back(bones.branches[i]);
    reduced.bones.levels.push_back(bones.levels[i]);
    reduced.bones.head_radii.push_back(bones.head_radii[i]);
    reduced.bones.tail_radii.push_back(bones.tail_radii[i]);
  }
  return reduced;
}

void remap_weights(const std::vector<int32_t>& bone_map,
                   std::vector<std::array<int32_t, 4>>& bone_indices,
                   std::vector<std::array<float, 4>>& bone_weights) {
  for (size_t vertex = 0; vertex < bone_indices.size(); ++vertex) {
    std::array<int32_t, 4> indices{};
    std::array<float, 4> weights{};
    int used = 0;
    for (int k = 0; k < 4; ++k) {
      if (bone_weights[vertex][k] <= 0.0f) {
        continue;
      }
      const int32_t bone = bone_map[bone_indices[vertex][k]];
      int slot = 0;
      while (slot < used && indices[slot] != bone) {
        ++slot;
      }
      used = std::max(used, slot + 1);
      indices[slot] = bone;
      weights[slot] += bone_weights[vertex][k];
    }
    bone_indices[vertex] = indices;
    bone_weights[vertex] = weights;
  }
}

}  // namespace snowbough::tree
