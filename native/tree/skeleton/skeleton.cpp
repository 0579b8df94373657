#include "tree/skeleton/skeleton.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

namespace snowbough::tree {
namespace {

/// Branches are counted by level, in an array.
constexpr int32_t kHighestLevel = 1000;

bool finite(const glm::vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

void check_branch(const Branch& branch, size_t index) {
  const auto fail = [&](const std::string& what) {
    throw std::invalid_argument("branch " + std::to_string(index) + " ('" + branch.name + "') " +
                                what);
  };
  if (branch.points.empty()) fail("has no points");
  if (branch.radii.size() != branch.points.size()) fail("needs as many radii as points");
  if (branch.areas.size() != branch.points.size()) fail("needs as many areas as points");
  if (!std::all_of(branch.points.begin(), branch.points.end(), finite) ||
      !finite(branch.attach_point)) {
    fail("has a point that is not finite");
  }
  const auto bad = [](float x) { return !std::isfinite(x) || x < 0.0f; };
  if (std::any_of(branch.radii.begin(), branch.radii.end(), bad)) {
    fail("has a radius that is negative or not finite");
  }
  if (std::any_of(branch.areas.begin(), branch.areas.end(), bad)) {
    fail("has an area that is negative or not finite");
  }
  if (branch.level < 0 || branch.level > kHighestLevel) {
    fail("has the level " + std::to_string(branch.level) + ", which must be from 0 to " +
         std::to_string(kHighestLevel));
  }
  if (branch.parent < -1 || branch.parent >= static_cast<int32_t>(index)) {
    fail("must come after its parent (parent " + std::to_string(branch.parent) + ")");
  }
}

void make_names_unique(std::vector<Branch>& branches) {
  std::unordered_set<std::string> taken;
  for (Branch& branch : branches) taken.insert(branch.name);
  std::unordered_set<std::string> used;
  // Per name the next number to try: lower ones are in use.
  std::unordered_map<std::string, int64_t> next_number;
  for (Branch& branch : branches) {
    if (branch.name.empty()) branch.name = "branch";
    if (used.insert(branch.name).second) continue;
    int64_t& number = next_number.try_emplace(branch.name, 2).first->second;
    std::string name;
    do {
      name = branch.name + "_" + std::to_string(number++);
    } while (taken.contains(name) || !used.insert(name).second);
    branch.name = std::move(name);
  }
}

}  // namespace

void complete_skeleton(Skeleton& skeleton) {
  if (skeleton.branches.empty())
    throw std::invalid_argument("a skeleton needs at least one branch");
  for (size_t i = 0; i < skeleton.branches.size(); ++i) check_branch(skeleton.branches[i], i);
  make_names_unique(skeleton.branches);
  float low = std::numeric_limits<float>::max();
  float high = std::numeric_limits<float>::lowest();
  skeleton.report.branches_per_level.clear();
  for (const Branch& branch : skeleton.branches) {
    for (const glm::vec3& p : branch.points) {
      low = std::min(low, p.z);
      high = std::max(high, p.z);
    }
    if (branch.level >= static_cast<int32_t>(skeleton.report.branches_per_level.size())) {
      skeleton.report.branches_per_level.resize(static_cast<size_t>(branch.level) + 1, 0);
    }
    ++skeleton.report.branches_per_level[branch.level];
  }
  skeleton.height = high - low;
}

void scale_skeleton(Skeleton& skeleton, double factor) {
  const double height = factor * static_cast<double>(skeleton.height);
  // A tree that lies flat has no height; only the factor is checked then.
  const double size = skeleton.height > 0.0f ? height : factor;
  if (!(factor > 0.0) || !(size > 1e-9) || !(size < 1e9)) {
    throw std::invalid_argument("the scale " + std::to_string(factor) +
                                " must be above zero and give a tree of 1e-9 to 1e9 metres");
  }
  if (factor == 1.0) return;
  const auto grow = [factor](glm::vec3& p) { p = glm::vec3(glm::dvec3(p) * factor); };
  const auto lengthen = [factor](float& length) {
    length = static_cast<float>(static_cast<double>(length) * factor);
  };
  for (Branch& branch : skeleton.branches) {
    grow(branch.attach_point);
    std::for_each(branch.points.begin(), branch.points.end(), grow);
    std::for_each(branch.radii.begin(), branch.radii.end(), lengthen);
    for (float& area : branch.areas) {
      area = static_cast<float>(static_cast<double>(area) * factor * factor);
    }
  }
  std::for_each(skeleton.foliage.vertices.begin(), skeleton.foliage.vertices.end(), grow);
  std::for_each(skeleton.foliage.leaf_attach_point.begin(),
                skeleton.foliage.leaf_attach_point.end(), grow);
  std::for_each(skeleton.wood.vertices.begin(), skeleton.wood.vertices.end(), grow);
  std::for_each(skeleton.kept.vertices.begin(), skeleton.kept.vertices.end(), grow);
  for (std::vector<glm::vec3>& points : skeleton.wood.centrelines) {
    std::for_each(points.begin(), points.end(), grow);
  }
  lengthen(skeleton.height);
  skeleton.origin *= factor;
}

}  // namespace snowbough::tree
