#include "tree/read/classify.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "tree/rings/squares.h"
#include "tree/skeleton/centreline.h"
#include "tree/welded/uneven_tubes.h"

namespace snowbough::tree {
namespace {

/// Fraction of a group's consecutive planes that must be perpendicular to the line between their
/// centres.
constexpr double kRowShare = 0.7;
/// Fraction of groups with exactly one tube at which a group counts as a branch.
constexpr double kOneTubeShare = 0.8;
/// The planes are in random order if more than this fraction of the turns from plane to plane go
/// back. Along limbs hardly any do; for limbs of two or three planes each, about half of them (0.48
/// on Betula lenta). In random order two thirds do along a straight limb, and more across a crown.
constexpr double kShuffledShare = 0.57;
/// Fewer turns do not decide.
constexpr size_t kFewestTurns = 20;
/// An unnamed closed tube shorter than this many of its radii is a fruit.
constexpr float kRoundest = 3.0f;

/// Fewest pieces that are taken for copies of one another, and the share of them that must not be
/// tubes for none to be one.
constexpr size_t kFewestCopies = 16;
constexpr double kOtherCopies = 0.2;

/// Maximum mean thickness of a tree's limbs relative to its size; a cow has 0.26, a rabbit 0.31.
constexpr double kThickestTree = 0.08;
/// A surface with fewer faces or limbs is not a whole tree.
constexpr size_t kFewestFaces = 24;
constexpr size_t kFewestLimbs = 3;
/// Height of the ground, as a share of the whole.
constexpr float kGround = 0.03f;

/// Minimum number of parts per thread at a time, and maximum number of progress reports.
constexpr size_t kTraceBlock = 32;
constexpr size_t kMaxBlocks = 1024;

/// Progress at which every part's shape is known; forking surfaces take the rest.
constexpr float kShapesFound = 0.5f;

enum class Shape : uint8_t { kUnknown, kTube, kPlane, kTriangle, kOther, kWithoutArea };

struct Shapes {
  std::vector<Shape> shape;
  std::vector<NotATube> why;
  /// By part: why a forking surface is not a tree.
  std::map<int32_t, std::string> refused;
};

/// Traces all parts that are not foliage by name.
Shapes find_shapes(const ObjScene& scene, const Parts& parts, const PartLabels& labels,
                   ClassifiedParts& result, const base::Execution& execution) {
  const auto count = static_cast<size_t>(parts.count());
  Shapes shapes;
  shapes.shape.assign(count, Shape::kUnknown);
  shapes.why.assign(count, NotATube::kNone);
  const size_t block = std::max(kTraceBlock, count / kMaxBlocks);
  // The limbs of each block, by part.
  std::vector<std::vector<std::pair<int32_t, Limb>>> traced(count / block + 1);
  const auto trace = [&](size_t begin, size_t end) {
    for (auto p = static_cast<int32_t>(begin); p < static_cast<int32_t>(end); ++p) {
      if (labels.meaning[p] == NameMeaning::kFoliage) continue;
      if (read_cross_section(scene, parts, p)) {
        shapes.shape[p] = Shape::kPlane;
      } else if (parts.part_faces(p).size() == 1) {
        shapes.shape[p] = part_area(scene, parts, p) > 0.0 ? Shape::kTriangle : Shape::kWithoutArea;
      } else if (std::optional<Limb> limb = trace_tube(scene, parts.part_faces(p),
                                                       parts.part_vertices(p), shapes.why[p])) {
        shapes.shape[p] = Shape::kTube;
        traced[begin / block].emplace_back(p, std::move(*limb));
      } else if (std::optional<Limb> uneven =
                     trace_uneven_tube(scene, parts.part_faces(p), parts.part_vertices(p))) {
        shapes.shape[p] = Shape::kTube;
        traced[begin / block].emplace_back(p, std::move(*uneven));
      } else {
        shapes.shape[p] = part_area(scene, parts, p) > 0.0 ? Shape::kOther : Shape::kWithoutArea;
      }
    }
  };
  base::parallel_for(count, block, execution, trace);
  result.limb.assign(count, -1);
  for (auto& limbs : traced) {
    for (auto& [part, limb] : limbs) {
      result.limb[part] = static_cast<int32_t>(result.limbs.size());
      result.limbs.push_back(std::move(limb));
    }
  }
  return shapes;
}

/// Copies of one piece have one shape: if some of many pieces with the same numbers of faces,
/// corners and vertices are no tubes, none is. Curved leaves resemble tubes one by one.
void refuse_leaves(const ObjScene& scene, const Parts& parts, const PartLabels& labels,
                   Shapes& shapes) {
  std::map<std::array<size_t, 3>, std::vector<int32_t>> copies;
  for (int32_t p = 0; p < parts.count(); ++p) {
    const bool counts = shapes.shape[p] == Shape::kTube || shapes.shape[p] == Shape::kOther;
    if (!counts || labels.meaning[p] != NameMeaning::kSilent) continue;
    size_t corners = 0;
    for (const int32_t f : parts.part_faces(p)) {
      corners += static_cast<size_t>(scene.face_begin[f + 1] - scene.face_begin[f]);
    }
    copies[{parts.part_faces(p).size(), corners, parts.part_vertices(p).size()}].push_back(p);
  }
  for (const auto& [size, members] : copies) {
    const auto others = std::count_if(members.begin(), members.end(),
                                      [&](int32_t p) { return shapes.shape[p] == Shape::kOther; });
    if (members.size() < kFewestCopies ||
        static_cast<double>(others) < kOtherCopies * static_cast<double>(members.size())) {
      continue;
    }
    for (const int32_t p : members) {
      if (shapes.shape[p] != Shape::kTube) continue;
      shapes.shape[p] = Shape::kOther;
      shapes.why[p] = NotATube::kUneven;
    }
  }
}

/// The parts of each label in file order; parts without label come first.
std::vector<std::vector<int32_t>> parts_by_label(const PartLabels& labels,
                                                 const std::vector<int32_t>& chosen) {
  std::vector<std::vector<int32_t>> groups(labels.names.size() + 1);
  for (const int32_t p : chosen) groups[labels.label[p] + 1].push_back(p);
  std::erase_if(groups, [](const auto& group) { return group.empty(); });
  return groups;
}

std::string rounded(double value) {
  std::ostringstream text;
  text.precision(2);
  text << value;
  return text.str();
}

/// Whether the flat part closes the limb: its outline is the limb's end ring.
bool is_cap_of(const ObjScene& scene, const Parts& parts, int32_t part, const Limb& limb) {
  Limb outline;
  std::vector<glm::vec3> corners;
  for (const int32_t v : parts.part_vertices(part)) corners.push_back(scene.positions[v]);
  append_ring(corners, outline);
  for (const size_t end : {size_t{0}, limb.points.size() - 1}) {
    const float radius = limb.radii[end];
    if (glm::distance(outline.points[0], limb.points[end]) <= 0.1f * radius &&
        outline.radii[0] <= 1.1f * radius && outline.radii[0] >= 0.5f * radius) {
      return true;
    }
  }
  return false;
}

bool is_round(const Limb& limb) {
  const float thickest = *std::max_element(limb.radii.begin(), limb.radii.end());
  return limb.radii.front() < 0.7f * thickest && limb.radii.back() < 0.7f * thickest &&
         polyline_length(limb.points) < kRoundest * thickest;
}

TreeForm form_of_tubes(const ObjScene& scene, const Parts& parts, const PartLabels& labels,
                       const ClassifiedParts& result) {
  std::vector<int32_t> tubes;
  std::set<int32_t> materials;
  for (int32_t p = 0; p < parts.count(); ++p) {
    if (result.role[p] == PartRole::kTube) tubes.push_back(p);
    if (result.role[p] != PartRole::kSkipped) materials.insert(scene.runs[parts.run[p]].material);
  }
  const std::vector<std::vector<int32_t>> groups = parts_by_label(labels, tubes);
  if (groups.size() >= 2) {
    const auto single = static_cast<double>(std::count_if(
        groups.begin(), groups.end(), [](const auto& group) { return group.size() == 1; }));
    return single >= kOneTubeShare * static_cast<double>(groups.size()) ? TreeForm::kTubesPerGroup
                                                                        : TreeForm::kTubesPerLevel;
  }
  return materials.size() >= 2 ? TreeForm::kMaterials : TreeForm::kMergedTubes;
}

/// Groups with rows of planes across limbs become wood; returns the form, if there are any.
std::optional<TreeForm> find_squares(const ObjScene& scene, const Parts& parts,
                                     const PartLabels& labels, const Shapes& shapes,
                                     ClassifiedParts& result) {
  size_t branches = 0;
  size_t rows = 0;
  Turns turns;
  std::vector<int32_t> planes;
  for (int32_t p = 0; p < parts.count(); ++p) {
    if (shapes.shape[p] == Shape::kPlane || shapes.shape[p] == Shape::kTriangle)
      planes.push_back(p);
  }
  for (const std::vector<int32_t>& group : parts_by_label(labels, planes)) {
    std::vector<int32_t> unread;
    const std::vector<CrossSection> sections = read_cross_sections(scene, parts, group, unread);
    if (sections.size() < 2) continue;
    const bool named = labels.meaning[group.front()] == NameMeaning::kWood;
    if (!named && row_share(sections) < kRowShare) continue;
    ++branches;
    rows += chain_cross_sections(sections).size();
    count_turns(sections, turns);
    for (const int32_t p : group) result.role[p] = PartRole::kCrossSection;
    for (const int32_t p : unread) {
      result.role[p] = PartRole::kSkipped;
      result.skipped.push_back({p, "a loose triangle in a row of planes"});
    }
  }
  result.shuffled =
      turns.all >= kFewestTurns &&
      static_cast<double>(turns.back) > kShuffledShare * static_cast<double>(turns.all);
  if (branches == 0) return std::nullopt;
  // A few groups with many rows each hold whole levels or the whole tree.
  const bool merged = branches == 1 ? rows > 1 : branches <= 8 && rows >= 4 * branches;
  return merged ? TreeForm::kMergedSquares : TreeForm::kSquaresPerGroup;
}

/// Why a forking surface is not a tree; empty if it is one.
std::string why_no_tree(const std::optional<WeldedTree>& welded) {
  if (!welded) return "has no extent";
  if (welded->thickness > kThickestTree) {
    return "not a tree: its limbs are " + rounded(welded->thickness) +
           " of its size thick on average, those of a tree less than " + rounded(kThickestTree);
  }
  if (welded->limbs.size() < kFewestLimbs)
    return "not a tree: its surface does not fork into limbs";
  return "";
}

/// The part with the largest area, if it has faces enough for a tree, reaches the ground, and its
/// name does not say foliage; else -1. The ground is at the low end of Y or Z.
int32_t largest_on_ground(const ObjScene& scene, const Parts& parts, const PartLabels& labels) {
  int32_t largest = -1;
  double most = 0.0;
  for (int32_t p = 0; p < parts.count(); ++p) {
    const double area = part_area(scene, parts, p);
    if (area > most) {
      most = area;
      largest = p;
    }
  }
  if (largest < 0 || labels.foliage_named || labels.meaning[largest] == NameMeaning::kFoliage ||
      parts.part_faces(largest).size() < kFewestFaces) {
    return -1;
  }
  glm::vec3 low(std::numeric_limits<float>::max());
  glm::vec3 high = -low;
  for (const int32_t v : parts.vertices) {
    low = glm::min(low, scene.positions[v]);
    high = glm::max(high, scene.positions[v]);
  }
  const glm::vec3 ground = low + kGround * (high - low);
  for (const int32_t v : parts.part_vertices(largest)) {
    const glm::vec3& at = scene.positions[v];
    if (at.y <= ground.y || at.z <= ground.z) return largest;
  }
  return -1;
}

/// Forking surfaces become wood if they are most of it.
/// @param tree  a part that counts whatever its share; -1: none.
void find_welded(const ObjScene& scene, const Parts& parts, const PartLabels& labels, int32_t tree,
                 const base::Progress& progress, Shapes& shapes, ClassifiedParts& result) {
  std::vector<int32_t> candidates;
  double forked = 0.0;
  double other = 0.0;
  for (int32_t p = 0; p < parts.count(); ++p) {
    if (result.role[p] == PartRole::kTube || result.role[p] == PartRole::kCrossSection) {
      other += part_area(scene, parts, p);
    } else if (shapes.shape[p] == Shape::kOther && labels.meaning[p] != NameMeaning::kFoliage &&
               parts.part_faces(p).size() >= kFewestFaces) {
      candidates.push_back(p);
      forked += part_area(scene, parts, p);
    }
  }
  if (forked <= other) {
    const bool counts = std::find(candidates.begin(), candidates.end(), tree) != candidates.end();
    if (tree < 0 || !counts) return;
    candidates.assign(1, tree);
    forked = part_area(scene, parts, tree);
  }
  double done = 0.0;
  for (const int32_t p : candidates) {
    const auto begin = static_cast<float>(done / forked);
    done += part_area(scene, parts, p);
    const base::Progress part =
        base::part_of(progress, begin, static_cast<float>(std::min(1.0, done / forked)));
    std::optional<WeldedTree> welded =
        trace_welded(scene, parts.part_faces(p), parts.part_vertices(p), part);
    std::string why = why_no_tree(welded);
    if (why.empty()) {
      result.role[p] = PartRole::kWelded;
      result.welded.emplace_back(p, std::move(*welded));
    } else {
      shapes.refused[p] = std::move(why);
    }
  }
}

}  // namespace

std::string form_name(TreeForm form) {
  switch (form) {
    case TreeForm::kSquaresPerGroup:
      return "SQUARES_PER_GROUP";
    case TreeForm::kTubesPerGroup:
      return "TUBES_PER_GROUP";
    case TreeForm::kTubesPerLevel:
      return "TUBES_PER_LEVEL";
    case TreeForm::kMergedTubes:
      return "MERGED_TUBES";
    case TreeForm::kMaterials:
      return "MATERIALS";
    case TreeForm::kMergedSquares:
      return "MERGED_SQUARES";
    case TreeForm::kWelded:
      return "WELDED";
  }
  return "";
}

ClassifiedParts classify_parts(const ObjScene& scene, const Parts& parts, const PartLabels& labels,
                               LargestPart largest, const base::Execution& execution) {
  ClassifiedParts result;
  result.role.assign(parts.count(), PartRole::kFoliage);
  Shapes shapes = find_shapes(scene, parts, labels, result, execution.part(0.0f, kShapesFound));

  refuse_leaves(scene, parts, labels, shapes);

  std::vector<int32_t> tubes;
  for (int32_t p = 0; p < parts.count(); ++p) {
    if (shapes.shape[p] != Shape::kTube) continue;
    if (labels.meaning[p] == NameMeaning::kSilent && is_round(result.limbs[result.limb[p]]))
      continue;
    result.role[p] = PartRole::kTube;
    tubes.push_back(p);
  }
  const std::optional<TreeForm> squares = find_squares(scene, parts, labels, shapes, result);
  const int32_t trunk = largest_on_ground(scene, parts, labels);
  find_welded(scene, parts, labels, largest == LargestPart::kTree ? trunk : -1,
              base::part_of(execution.progress, kShapesFound, 1.0f), shapes, result);

  for (int32_t p = 0; p < parts.count(); ++p) {
    if (result.role[p] != PartRole::kFoliage || labels.meaning[p] == NameMeaning::kFoliage)
      continue;
    const auto skip = [&](std::string why, bool wood = true) {
      result.role[p] = PartRole::kSkipped;
      result.skipped.push_back({p, std::move(why), wood});
    };
    // It may close the tubes just before and after it in the file.
    const auto after = std::lower_bound(tubes.begin(), tubes.end(), p);
    const bool cap =
        (after != tubes.end() && is_cap_of(scene, parts, p, result.limbs[result.limb[*after]])) ||
        (after != tubes.begin() &&
         is_cap_of(scene, parts, p, result.limbs[result.limb[after[-1]]]));
    const auto refused = shapes.refused.find(p);
    if (shapes.shape[p] == Shape::kWithoutArea) {
      skip("without area", false);
    } else if (cap) {
      skip("a cap that closes a tube's end");
    } else if (refused != shapes.refused.end()) {
      skip(refused->second);
    } else if (labels.meaning[p] == NameMeaning::kWood) {
      skip(shapes.shape[p] == Shape::kOther ? reason_text(shapes.why[p])
                                            : "a single plane, not a limb");
    } else if (shapes.shape[p] == Shape::kOther &&
               (shapes.why[p] == NotATube::kForks || p == trunk)) {
      skip(reason_text(shapes.why[p]));
    } else if (labels.foliage_named) {
      skip("not a limb, and not named as foliage", false);
    }
  }
  result.foliage_count =
      static_cast<int32_t>(std::count(result.role.begin(), result.role.end(), PartRole::kFoliage));
  const bool squares_lead =
      squares &&
      tubes.size() * 2 < static_cast<size_t>(std::count(result.role.begin(), result.role.end(),
                                                        PartRole::kCrossSection));
  result.form = !result.welded.empty() ? TreeForm::kWelded
                : squares_lead         ? *squares
                                       : form_of_tubes(scene, parts, labels, result);
  base::report_progress(execution.progress, 1.0f);
  return result;
}

}  // namespace snowbough::tree
