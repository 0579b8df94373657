#include "tree/mesh/bones.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

namespace snowbough::tree {
namespace {

/// Square corners at sqrt(area / 2) represent a round limb of radius sqrt(area / pi).
float limb_radius(double corner) {
  return static_cast<float>(corner * std::sqrt(2.0 / M_PI));
}

float distance_to_segment(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 ab = b - a;
  const float square = glm::dot(ab, ab);
  const float t = square > 0.0f ? std::clamp(glm::dot(p - a, ab) / square, 0.0f, 1.0f) : 0.0f;
  return glm::distance(p, a + ab * t);
}

}  // namespace

Armature make_bones(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                    const LengthLimits& scale, bool root_bone) {
  Armature armature;
  Bones& bones = armature.bones;
  const auto add = [&bones, &skeleton](int32_t branch, int32_t parent, std::string name) {
    bones.parents.push_back(parent);
    bones.names.push_back(std::move(name));
    bones.branches.push_back(branch);
    bones.levels.push_back(skeleton.branches[branch].level);
  };
  const auto is_root = [](const Branch& branch) { return branch.parent < 0; };
  const bool has_root_bone =
      root_bone && std::count_if(skeleton.branches.begin(), skeleton.branches.end(), is_root) > 1;
  if (has_root_bone) {
    const LimbPath& first = paths.front();
    const double length = std::max(first.corners.front(), scale.smallest_knuckle);
    bones.heads.push_back(glm::vec3(first.points.front() - glm::dvec3(0.0, 0.0, length)));
    bones.tails.push_back(glm::vec3(first.points.front()));
    bones.head_radii.push_back(limb_radius(first.corners.front()));
    bones.tail_radii.push_back(limb_radius(first.corners.front()));
    add(0, -1, "root");
  }
  std::set<std::string> names;
  // Per limb with children.
  std::vector<std::optional<PathSearch>> searches(paths.size());
  for (size_t b = 0; b < paths.size(); ++b) {
    const Branch& branch = skeleton.branches[b];
    const LimbPath& path = paths[b];
    const auto first = static_cast<int32_t>(bones.heads.size());
    armature.first_bone.push_back(first);

    int32_t parent = has_root_bone ? 0 : -1;
    if (branch.parent >= 0) {
      const LimbPath& holder = paths[branch.parent];
      // Slightly towards the root, so that rounding does not pick the bone that starts at a joint.
      std::optional<PathSearch>& search = searches[branch.parent];
      if (!search) search.emplace(holder);
      const double s = search->nearest_length(glm::dvec3(branch.attach_point)) - scale.coincident;
      parent = armature.first_bone[branch.parent] + segment_at(holder.lengths, s);
    }
    std::string name =
        branch.name.empty() ? std::string("branch").append(std::to_string(b)) : branch.name;
    while (!names.insert(name).second) {
      name.append("_").append(std::to_string(b));
    }
    for (size_t i = 0; i + 1 < path.points.size(); ++i) {
      bones.heads.push_back(glm::vec3(path.points[i]));
      bones.tails.push_back(glm::vec3(path.points[i + 1]));
      add(static_cast<int32_t>(b), i == 0 ? parent : first + static_cast<int32_t>(i) - 1,
          std::string(name).append(".").append(std::to_string(i)));
      bones.head_radii.push_back(limb_radius(path.corners[i]));
      bones.tail_radii.push_back(limb_radius(path.corners[i + 1]));
    }
  }
  return armature;
}

std::vector<int32_t> leaf_bones(const Skeleton& skeleton, const Bones& bones) {
  const size_t branch_count = skeleton.branches.size();
  std::vector<int32_t> begin(branch_count + 1, 0);
  for (int32_t branch : bones.branches) {
    if (branch < 0 || static_cast<size_t>(branch) >= branch_count) {
      throw std::invalid_argument(
          "the mesh was built from another skeleton: it has bones of branch " +
          std::to_string(branch));
    }
    ++begin[branch + 1];
  }
  for (size_t b = 0; b < branch_count; ++b) {
    begin[b + 1] += begin[b];
  }
  const Foliage& foliage = skeleton.foliage;
  std::vector<int32_t> result;
  result.reserve(foliage.leaf_branch.size());
  for (size_t leaf = 0; leaf < foliage.leaf_branch.size(); ++leaf) {
    // If a branch has lost its bones to the budget, its leaves follow the nearest ancestor with
    // bones.
    int32_t branch = foliage.leaf_branch[leaf];
    while (branch >= 0 && begin[branch] == begin[branch + 1]) {
      branch = skeleton.branches[branch].parent;
    }
    int32_t best = branch >= 0 ? begin[branch] : 0;
    float best_distance = INFINITY;
    for (int32_t bone = best; branch >= 0 && bone < begin[branch + 1]; ++bone) {
      const float distance = distance_to_segment(foliage.leaf_attach_point[leaf], bones.heads[bone],
                                                 bones.tails[bone]);
      if (distance < best_distance) {
        best_distance = distance;
        best = bone;
      }
    }
    result.push_back(best);
  }
  return result;
}

}  // namespace snowbough::tree
