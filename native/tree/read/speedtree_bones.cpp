#include "tree/read/speedtree_bones.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>

#include "tree/read/up_axis.h"
#include "tree/skeleton/centreline.h"
#include "tree/skeleton/segment_tree.h"

namespace snowbough::tree {
namespace {

/// Metres of SpeedTree's units, and their inverses: feet, metres and centimetres.
constexpr std::array kScales = {1.0, 100.0, 0.01, 30.48, 1.0 / 30.48, 0.3048, 1.0 / 0.3048};
/// Sizes of both differ by less than this factor: leaves and twigs may have no bones.
constexpr double kSizes = 2.5;
/// Points of the mesh that are compared, and their greatest median distance from the limbs, as a
/// fraction of the tree's size.
constexpr size_t kSamples = 500;
constexpr double kFarthest = 0.03;
/// Units and axes other than the file's own must fit better by this factor.
constexpr double kBetter = 0.8;
/// Two bones of a limb meet within this fraction of their lengths, and turn by less than 90
/// degrees.
constexpr double kMeets = 0.05;

class Element {
 public:
  Element(std::string_view attributes, const std::string& name, size_t line)
      : attributes_(attributes), name_(name), line_(line) {}

  std::optional<std::string_view> find(std::string_view key) const {
    for (size_t at = attributes_.find(key); at != std::string_view::npos;
         at = attributes_.find(key, at + 1)) {
      const bool begins = at > 0 && std::isspace(static_cast<unsigned char>(attributes_[at - 1]));
      size_t after = attributes_.find_first_not_of(" \t\r\n", at + key.size());
      if (!begins || after == std::string_view::npos || attributes_[after] != '=') continue;
      after = attributes_.find_first_not_of(" \t\r\n", after + 1);
      if (after == std::string_view::npos) continue;
      const char quote = attributes_[after];
      const size_t end = attributes_.find(quote, after + 1);
      if ((quote != '"' && quote != '\'') || end == std::string_view::npos) continue;
      return attributes_.substr(after + 1, end - after - 1);
    }
    return std::nullopt;
  }

  double number(std::string_view key) const {
    const std::optional<std::string_view> found = find(key);
    if (!found) fail("a bone lacks " + std::string(key));
    std::string text(*found);
    std::replace(text.begin(), text.end(), ',', '.');
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
      fail("'" + std::string(*found) + "' is no number");
    }
    return value;
  }

  glm::dvec3 point(const std::string& key) const {
    return {number(key + "X"), number(key + "Y"), number(key + "Z")};
  }

  int64_t whole(std::string_view key) const {
    const double value = number(key);
    if (value != std::floor(value) || std::abs(value) > 1e15) {
      fail(std::string(key) + " is no whole number");
    }
    return static_cast<int64_t>(value);
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw std::invalid_argument(name_ + ":" + std::to_string(line_) + ": " + why);
  }

 private:
  std::string_view attributes_;
  const std::string& name_;
  size_t line_;
};

/// Per bone: the index of its parent, or -1.
std::vector<int32_t> parents_of(const std::vector<SpeedTreeBone>& bones) {
  std::map<int64_t, int32_t> index;
  for (size_t i = 0; i < bones.size(); ++i) index[bones[i].id] = static_cast<int32_t>(i);
  std::vector<int32_t> parents;
  for (const SpeedTreeBone& bone : bones) {
    parents.push_back(bone.parent < 0 ? -1 : index.at(bone.parent));
  }
  return parents;
}

void check_hierarchy(const std::vector<SpeedTreeBone>& bones, const std::string& name) {
  std::map<int64_t, size_t> index;
  for (size_t i = 0; i < bones.size(); ++i) {
    if (!index.emplace(bones[i].id, i).second) {
      throw std::invalid_argument(name + ": two bones have the ID " + std::to_string(bones[i].id));
    }
  }
  for (const SpeedTreeBone& bone : bones) {
    if (bone.parent >= 0 && index.count(bone.parent) == 0) {
      throw std::invalid_argument(name + ": bone " + std::to_string(bone.id) + " grows from " +
                                  std::to_string(bone.parent) + ", which does not exist");
    }
  }
  const std::vector<int32_t> parents = parents_of(bones);
  // 1: being followed, 2: leads to a root.
  std::vector<uint8_t> state(bones.size(), 0);
  for (size_t i = 0; i < bones.size(); ++i) {
    std::vector<int32_t> way;
    int32_t at = static_cast<int32_t>(i);
    while (at >= 0 && state[at] == 0) {
      state[at] = 1;
      way.push_back(at);
      at = parents[at];
    }
    if (at >= 0 && state[at] == 1) {
      throw std::invalid_argument(name + ": bone " + std::to_string(bones[at].id) +
                                  " is its own ancestor");
    }
    for (const int32_t bone : way) state[bone] = 2;
  }
}

void add_point(const glm::dvec3& point, double radius, Branch& branch) {
  branch.points.emplace_back(point);
  branch.radii.push_back(static_cast<float>(radius));
  branch.areas.push_back(static_cast<float>(M_PI * radius * radius));
}

/// The bone that goes on from `bone`, or -1.
int32_t next_bone(const std::vector<SpeedTreeBone>& bones, int32_t bone,
                  const std::vector<int32_t>& children) {
  const glm::dvec3 along = bones[bone].end - bones[bone].start;
  int32_t best = -1;
  double best_cosine = 0.0;
  for (const int32_t child : children) {
    const glm::dvec3 way = bones[child].end - bones[child].start;
    const double lengths = glm::length(along) * glm::length(way);
    const bool meets = glm::distance(bones[bone].end, bones[child].start) <=
                       kMeets * (glm::length(along) + glm::length(way));
    const double cosine = lengths > 0.0 ? glm::dot(along, way) / lengths : 1.0;
    if (meets && bones[child].generator == bones[bone].generator && cosine > best_cosine) {
      best = child;
      best_cosine = cosine;
    }
  }
  return best;
}

std::string branch_name(const SpeedTreeBone& bone) {
  std::string name = bone.generator.empty() ? "branch" : bone.generator;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

double extent(const std::vector<glm::vec3>& points) {
  glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
  for (const glm::vec3& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::vec3 size = high - low;
  return std::max({size.x, size.y, size.z});
}

template <typename Move>
std::vector<Branch> moved(std::vector<Branch> branches, double scale, const Move& move) {
  for (Branch& branch : branches) {
    for (glm::vec3& p : branch.points) p = move(p) * static_cast<float>(scale);
    branch.attach_point = move(branch.attach_point) * static_cast<float>(scale);
    for (float& radius : branch.radii) radius *= static_cast<float>(scale);
    for (float& area : branch.areas) area *= static_cast<float>(scale * scale);
  }
  return branches;
}

/// Median distance of points from the limbs' surfaces.
double median_distance(const std::vector<glm::vec3>& points, const std::vector<Branch>& branches) {
  const SegmentTree segments(branches, std::vector<int32_t>(branches.size(), 0), 0.0f);
  std::vector<double> distances;
  for (const glm::vec3& p : points) {
    const NearestSegment found = segments.nearest(p, 1, Measure::kSurface);
    distances.push_back(std::abs(found.distance - found.radius));
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

}  // namespace

std::vector<SpeedTreeBone> parse_speedtree_bones(std::string_view text, const std::string& name) {
  constexpr std::string_view kTag = "<Bone";
  std::vector<SpeedTreeBone> bones;
  size_t line = 1, counted = 0;
  for (size_t at = text.find(kTag); at != std::string_view::npos; at = text.find(kTag, at + 1)) {
    const size_t begin = at + kTag.size();
    if (begin >= text.size() || !std::isspace(static_cast<unsigned char>(text[begin]))) continue;
    line += static_cast<size_t>(std::count(text.begin() + static_cast<std::ptrdiff_t>(counted),
                                           text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
    counted = at;
    const size_t end = text.find('>', begin);
    const Element element(text.substr(begin, end - begin), name, line);
    if (end == std::string_view::npos) element.fail("the file ends within a bone");
    SpeedTreeBone bone;
    bone.id = element.whole("ID");
    bone.parent = element.whole("ParentID");
    bone.radius = element.number("Radius");
    if (bone.radius < 0.0) element.fail("a bone's Radius is negative");
    bone.start = element.point("Start");
    bone.end = element.point("End");
    bone.generator = element.find("Generator").value_or("");
    bones.push_back(std::move(bone));
  }
  if (bones.empty()) {
    throw std::invalid_argument(
        name + ": has no bones: export SpeedTree's raw XML with bones, beside the mesh");
  }
  check_hierarchy(bones, name);
  return bones;
}

std::vector<SpeedTreeBone> read_speedtree_bones(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open() || file.bad()) throw std::runtime_error(path + ": cannot be read");
  return parse_speedtree_bones(text, path);
}

std::vector<Branch> branches_of_bones(const std::vector<SpeedTreeBone>& bones) {
  const std::vector<int32_t> parents = parents_of(bones);
  std::vector<std::vector<int32_t>> children(bones.size());
  // Bones that begin a branch, and the branch that they leave; parents come first.
  std::vector<std::pair<int32_t, int32_t>> begins;
  for (size_t i = 0; i < bones.size(); ++i) {
    if (parents[i] >= 0) children[parents[i]].push_back(static_cast<int32_t>(i));
    if (parents[i] < 0) begins.emplace_back(static_cast<int32_t>(i), begins.empty() ? -1 : 0);
  }
  std::vector<Branch> branches;
  for (size_t i = 0; i < begins.size(); ++i) {
    const auto [first, parent] = begins[i];
    const auto number = static_cast<int32_t>(branches.size());
    Branch branch;
    branch.name = branch_name(bones[first]);
    branch.parent = parent;
    branch.level = parent < 0 ? 0 : branches[parent].level + 1;
    for (int32_t bone = first; bone >= 0;) {
      add_point(bones[bone].start, bones[bone].radius, branch);
      const int32_t next = next_bone(bones, bone, children[bone]);
      for (const int32_t child : children[bone]) {
        if (child != next) begins.emplace_back(child, number);
      }
      if (next < 0) add_point(bones[bone].end, bones[bone].radius, branch);
      bone = next;
    }
    branch.attach_point = parent < 0 ? branch.points.front()
                                     : nearest_place(branches[parent], branch.points.front()).point;
    branches.push_back(std::move(branch));
  }
  return branches;
}

void fit_branches(const std::vector<glm::vec3>& points, const std::string& name,
                  std::vector<Branch>& branches) {
  std::vector<glm::vec3> samples;
  const size_t step = std::max<size_t>(points.size() / kSamples, 1);
  for (size_t i = 0; i < points.size(); i += step) samples.push_back(points[i]);
  std::vector<glm::vec3> joints;
  for (const Branch& branch : branches) {
    joints.insert(joints.end(), branch.points.begin(), branch.points.end());
  }
  const double size = extent(points), own = extent(joints);
  const std::vector<Branch> original(branches);
  double best = std::numeric_limits<double>::infinity();
  for (const double scale : kScales) {
    if (own * scale > kSizes * size || own * scale * kSizes < size) continue;
    for (int axes = 0; axes < 3; ++axes) {
      std::vector<Branch> tried = moved(original, scale, [axes](const glm::vec3& p) {
        return axes == 0 ? p : axes == 1 ? y_up_to_z_up(p) : glm::vec3(p.x, p.z, -p.y);
      });
      const double distance = median_distance(samples, tried);
      if (distance >= kBetter * best) continue;
      best = distance;
      branches = std::move(tried);
    }
  }
  if (best <= kFarthest * size) return;
  throw std::invalid_argument(
      name +
      ": its bones do not lie in the wood of the mesh: export both files of the same tree, with "
      "its own place and rotation");
}

}  // namespace snowbough::tree
