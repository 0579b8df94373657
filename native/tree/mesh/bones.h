#pragma once

#include <cstdint>
#include <vector>

#include "tree/skeleton/skeleton.h"
#include "tree/skeleton/tree_mesh.h"
#include "tree/surface/limb_path.h"

namespace snowbough::tree {

/// The armature, and the first bone of each branch.
struct Armature {
  Bones bones;
  /// Per branch: index of the bone of its first segment; its other bones follow.
  std::vector<int32_t> first_bone;
};

/// One bone per segment of each branch's path, branch by branch, so that parents come before
/// children. A branch's first bone is a child of the parent's bone at its attach point; at a joint,
/// of the bone that ends there.
/// @param root_bone  whether a tree of several roots has one more bone, the first: it ends where
/// its
///   first root begins, as long as that is thick, and holds the first bones of all roots. No vertex
///   has a weight of it.
Armature make_bones(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                    const LengthLimits& scale, bool root_bone = true);

/// Per leaf: the bone of its branch nearest to its attach point.
/// @throws std::invalid_argument if the mesh was not built from this skeleton.
std::vector<int32_t> leaf_bones(const Skeleton& skeleton, const Bones& bones);

}  // namespace snowbough::tree
