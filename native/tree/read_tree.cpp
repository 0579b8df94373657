#include "tree/read_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "base/parallel_for.h"
#include "tree/coverage/coverage.h"
#include "tree/kept/kept_surface.h"
#include "tree/kept/upright.h"
#include "tree/obj/mtl_reader.h"
#include "tree/obj/obj_reader.h"
#include "tree/obj/parts.h"
#include "tree/obj/seams.h"
#include "tree/read/classify.h"
#include "tree/read/foliage.h"
#include "tree/read/left_out.h"
#include "tree/read/limbs.h"
#include "tree/read/part_names.h"
#include "tree/read/plausible.h"
#include "tree/read/speedtree_bones.h"
#include "tree/read/up_axis.h"
#include "tree/read/wood.h"
#include "tree/skeleton/attach.h"

namespace snowbough::tree {
namespace {

/// Level names are used while no more than this fraction of the branches finds no parent by them.
constexpr double kMaxUnattached = 0.2;
/// If more of the wood than this is left out, and few limbs remain, it is not a tree. A tree with
/// ground has a higher fraction.
constexpr double kMaxLeftOut = 0.75;
constexpr size_t kFewLimbs = 4;
/// Parts named in a warning about coverage.
constexpr size_t kNamedParts = 3;
/// Advice for stumps, ferns and stones.
constexpr const char* kNoLimbsNeeded =
    ". A plant without limbs, such as a stump or a fern, carries snow as it is: import its mesh "
    "with "
    "Blender's own importer and add it to the receivers, or import it here with Keep Original "
    "Surface to bend it";
/// Gain in covered area for which another reading is taken.
constexpr double kBetter = 1.05;
/// Distance from the file's origin, in tree sizes, beyond which the tree gets its own origin.
constexpr double kFar = 100.0;

void report_scene(const ObjScene& scene, ImportReport& report) {
  if (scene.short_faces > 0) {
    report.skipped_parts.emplace_back(
        "(faces)", std::to_string(scene.short_faces) + " faces with fewer than three corners");
  }
  if (scene.loose_elements > 0) {
    report.skipped_parts.emplace_back(
        "(lines and points)", std::to_string(scene.loose_elements) + " line or point elements");
  }
}

float extent_of(const std::vector<Branch>& branches) {
  glm::vec3 low(std::numeric_limits<float>::max());
  glm::vec3 high(std::numeric_limits<float>::lowest());
  for (const Branch& branch : branches) {
    for (const glm::vec3& p : branch.points) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }
  const glm::vec3 extent = high - low;
  return std::max({extent.x, extent.y, extent.z});
}

/// Connects by level names, and again by thickness if the names prove to give no levels.
void connect(TracedBranches& traced, bool levels_given, std::vector<std::string>& warnings,
             const base::Progress& progress) {
  const float size = extent_of(traced.branches);
  attach_branches(traced.branches, traced.reversible, size, base::part_of(progress, 0.0f, 0.5f));
  const bool may_doubt =
      !levels_given && std::any_of(traced.branches.begin(), traced.branches.end(),
                                   [](const Branch& b) { return b.level > 0; });
  if (!may_doubt) return;
  double unattached = 0.0;
  for (const Branch& branch : traced.branches) {
    unattached += branch.parent < 0 && branch.level > 0 ? 1.0 : 0.0;
  }
  if (unattached <= kMaxUnattached * static_cast<double>(traced.branches.size())) return;
  for (Branch& branch : traced.branches) {
    branch.level = -1;
    branch.parent = -1;
  }
  attach_branches(traced.branches, traced.reversible, size, base::part_of(progress, 0.5f, 1.0f));
  warnings.emplace_back(
      "the groups' names give no levels; branches were connected by thickness (set level names to "
      "overrule)");
}

/// Merged forms have no names: trunk, branch1_1, branch1_2, branch2_1 ...
void name_by_level(std::vector<Branch>& branches) {
  std::map<int32_t, int32_t> count;
  for (Branch& branch : branches) {
    const int32_t number = ++count[branch.level];
    if (branch.level == 0) {
      branch.name = number == 1 ? "trunk" : "trunk_" + std::to_string(number);
    } else {
      branch.name = "branch" + std::to_string(branch.level) + "_" + std::to_string(number);
    }
  }
}

/// A root with similar ends has its base at the lower one.
void orient_roots(TracedBranches& traced) {
  for (size_t b = 0; b < traced.branches.size(); ++b) {
    Branch& branch = traced.branches[b];
    if (branch.parent < 0 && traced.reversible[b] &&
        branch.points.back().z < branch.points.front().z) {
      std::reverse(branch.points.begin(), branch.points.end());
      std::reverse(branch.radii.begin(), branch.radii.end());
      std::reverse(branch.areas.begin(), branch.areas.end());
      branch.attach_point = branch.points.front();
    }
  }
}

/// Fills in the library data of the materials of wood and leaves.
void describe_materials(const ObjScene& scene, const std::string& path, bool outside_files,
                        Skeleton& skeleton) {
  if (scene.materials.empty() && scene.material_libraries.empty()) return;
  const std::array all = {&skeleton.wood.materials, &skeleton.kept.materials,
                          &skeleton.foliage.materials};
  std::set<std::string> used;
  for (const std::vector<ObjMaterial>* materials : all) {
    for (const ObjMaterial& material : *materials) used.insert(material.name);
  }
  const std::map<std::string, ObjMaterial> library =
      read_materials(path, scene.material_libraries, used, outside_files, skeleton.report.warnings);
  for (std::vector<ObjMaterial>* materials : all) {
    for (ObjMaterial& material : *materials) {
      const auto found = library.find(material.name);
      if (found != library.end()) material = found->second;
    }
  }
}

/// The file's parts, their labels and their roles.
struct SortedParts {
  Parts parts;
  PartLabels labels;
  ClassifiedParts classified;

  bool has_role(PartRole role) const {
    return std::find(classified.role.begin(), classified.role.end(), role) != classified.role.end();
  }
  bool has_wood() const {
    return has_role(PartRole::kTube) || has_role(PartRole::kCrossSection) ||
           has_role(PartRole::kWelded);
  }
};

SortedParts sort_parts(const ObjScene& scene, const std::string& foliage_names, bool foliage_words,
                       LargestPart largest, const base::Execution& execution) {
  SortedParts sorted;
  sorted.parts = split_parts(scene, base::part_of(execution.progress, 0.0f, 0.3f));
  sorted.labels = label_parts(scene, sorted.parts, foliage_names, foliage_words);
  sorted.classified =
      classify_parts(scene, sorted.parts, sorted.labels, largest, execution.part(0.3f, 1.0f));
  return sorted;
}

/// Sorts by names and shapes; by shapes alone if names leave no wood.
SortedParts sort_parts(const ObjScene& scene, const std::string& foliage_names, LargestPart largest,
                       std::vector<std::string>& warnings, const base::Execution& execution) {
  SortedParts by_names = sort_parts(scene, foliage_names, true, largest, execution);
  if (by_names.has_wood() || !by_names.has_role(PartRole::kFoliage) || !foliage_names.empty()) {
    return by_names;
  }
  SortedParts by_shape =
      sort_parts(scene, foliage_names, false, largest, execution.part(1.0f, 1.0f));
  if (!by_shape.has_wood()) return by_names;
  warnings.emplace_back(
      "by their names all parts are foliage; wood and leaves were distinguished by shape");
  return by_shape;
}

/// Whether there are branches, and not hardly any without names that confirm them.
bool has_limbs(const TracedBranches& traced, const LeftOut& left_out) {
  return !traced.branches.empty() &&
         (traced.named || left_out.share < kMaxLeftOut || traced.branches.size() >= kFewLimbs);
}

/// @throws std::invalid_argument if there are none, or hardly any without names that confirm them.
void check_branches(const TracedBranches& traced, int32_t foliage_count, const LeftOut& left_out,
                    const std::string& path) {
  if (has_limbs(traced, left_out)) return;
  if (!traced.branches.empty()) {
    throw std::invalid_argument(
        path + ": is not a tree: " + std::to_string(static_cast<int>(100.0 * left_out.share)) +
        " % of it is not wood, its largest part is " + left_out.why + kNoLimbsNeeded +
        ". If it is a tree, name its groups trunk, branch and so on");
  }
  if (!left_out.why.empty()) {
    throw std::invalid_argument(path + ": has no branches; its largest part is " + left_out.why +
                                kNoLimbsNeeded +
                                ". If it is a tree, export it with its trunk and branches");
  }
  throw std::invalid_argument(
      path + ": has no branches, " +
      (foliage_count > 0 ? "only " + std::to_string(foliage_count) + " leaves or other loose parts"
                         : std::string("none of its parts is a tube or a row of planes")) +
      kNoLimbsNeeded + ". If it is a tree, export it with its trunk and branches");
}

/// @throws std::invalid_argument if branches found by shape alone are not a tree.
void check_tree(const TracedBranches& traced, const std::string& path) {
  const std::string why = traced.named ? "" : why_no_tree(traced.branches);
  if (why.empty()) return;
  throw std::invalid_argument(path + ": is not a tree: " + why + kNoLimbsNeeded +
                              ". If it is a tree, give its level names, or name its groups trunk, "
                              "branch and so on");
}

/// The centre of the used vertices, if it is so far from the file's origin that single precision
/// would lose parts of the tree; else zero.
glm::dvec3 place_far_away(const ObjScene& scene) {
  glm::dvec3 low(std::numeric_limits<double>::max()), high(-low);
  for (const int32_t v : scene.corner_vertex) {
    low = glm::min(low, glm::dvec3(scene.positions[v]));
    high = glm::max(high, glm::dvec3(scene.positions[v]));
  }
  const glm::dvec3 middle = 0.5 * (low + high), size = high - low, away = glm::abs(middle);
  const bool is_far =
      std::max({away.x, away.y, away.z}) > kFar * std::max({size.x, size.y, size.z});
  return is_far ? middle : glm::dvec3(0.0);
}

/// Gives a tree that is far from the file's origin its own. @return whether it is.
bool take_origin(const ObjScene& scene, Skeleton& skeleton) {
  skeleton.origin = place_far_away(scene);
  if (skeleton.origin == glm::dvec3(0.0)) return false;
  skeleton.report.warnings.emplace_back(
      "the tree is far from the file's origin: it was built at the origin and then moved there");
  return true;
}

/// Reads the file, relative to the tree's centre if that is far away.
ObjScene read_scene(const std::string& path, const ReadTreeOptions& options, Skeleton& skeleton) {
  ObjReadOptions read_options;
  read_options.buffer_size = options.buffer_size;
  read_options.threads = options.threads;
  read_options.progress = base::part_of(options.progress, 0.0f, 0.5f);
  ObjScene scene = read_obj_file(path, read_options);
  if (!take_origin(scene, skeleton)) return scene;
  read_options.origin = skeleton.origin;
  return read_obj_file(path, read_options);
}

/// The file's wood as it was understood, not yet connected.
struct Reading {
  SortedParts sorted;
  TracedBranches traced;
  LeftOut left_out;
  Coverage coverage;
  /// Its skipped parts and warnings are those of this reading.
  ImportReport report;
};

Reading read_wood(const ObjScene& scene, const ReadTreeOptions& options, LargestPart largest,
                  const base::Execution& execution) {
  Reading reading;
  ImportReport& report = reading.report;
  reading.sorted = sort_parts(scene, options.foliage_names, largest, report.warnings, execution);
  const auto& [parts, labels, classified] = reading.sorted;
  reading.left_out = report_left_out(scene, parts, labels, classified, report);
  TracedBranches& traced = reading.traced;
  traced = trace_branches(scene, parts, labels, reading.sorted.classified);
  traced.form = classified.form;
  if (classified.shuffled) {
    report.warnings.emplace_back(
        "the squares seem to be in random order in the file, so limbs may run to and fro: export "
        "the squares of each limb in order, from its root to its tip");
  }
  traced.named = !options.levels.empty() || !options.foliage_names.empty() ||
                 std::any_of(labels.meaning.begin(), labels.meaning.end(),
                             [](NameMeaning m) { return m != NameMeaning::kSilent; });
  reading.coverage = measure_coverage(scene, parts, classified, traced.branches);
  return reading;
}

/// Reads the wood. If its limbs represent too little of it, reads it again with equal positions
/// joined and its largest part taken for the tree; `scene` is then the joined one.
Reading read_wood(ObjScene& scene, const ReadTreeOptions& options,
                  const base::Execution& execution) {
  Reading first = read_wood(scene, options, LargestPart::kAny, execution);
  if (!first.traced.branches.empty() && first.coverage.share() >= kLowCoverage) return first;
  ObjScene joined = scene;
  weld_positions(joined);
  Reading second = read_wood(joined, options, LargestPart::kTree, execution.part(1.0f, 1.0f));
  if (second.traced.branches.empty() ||
      second.coverage.covered < kBetter * first.coverage.covered ||
      second.coverage.share() < first.coverage.share()) {
    return first;
  }
  second.report.warnings.emplace_back(
      "the limbs did not fit the file's polygons; it was read again with vertices at equal "
      "positions joined");
  scene = std::move(joined);
  return second;
}

/// Replaces what was read by one limb from the ground to the top: for stumps and other surfaces
/// without limbs. All that is not named as foliage belongs to it.
void stand_as_one(const ObjScene& scene, UpAxis up_axis, Reading& reading) {
  auto& [parts, labels, classified] = reading.sorted;
  classified.welded.clear();
  classified.skipped.clear();
  int32_t first = -1;
  std::vector<char> used(scene.positions.size(), 0);
  for (int32_t p = 0; p < parts.count(); ++p) {
    if (labels.meaning[p] == NameMeaning::kFoliage) continue;
    classified.role[p] = PartRole::kTube;
    if (first < 0) first = p;
    for (const int32_t v : parts.part_vertices(p)) used[v] = 1;
  }
  reading.report = {};
  reading.left_out = {};
  reading.coverage = {};
  reading.traced = {};
  if (first < 0) return;
  const int up = up_axis == UpAxis::kZ ? 2 : 1;
  Branch trunk = upright_limb(scene.positions, used, up);
  trunk.name = "trunk";
  trunk.piece = first;
  reading.traced.branches.push_back(std::move(trunk));
  reading.traced.reversible.push_back(0);
  reading.traced.label.push_back(-1);
  reading.traced.named = true;
  classified.foliage_count = static_cast<int32_t>(
      std::count(classified.role.begin(), classified.role.end(), PartRole::kFoliage));
}

/// Wood and leaves by names and shape, with the bones of another file for its branches.
Reading read_with_bones(const ObjScene& scene, const ReadTreeOptions& options,
                        const glm::dvec3& origin, const base::Execution& execution) {
  Reading reading;
  reading.sorted = sort_parts(scene, options.foliage_names, LargestPart::kTree,
                              reading.report.warnings, execution);
  auto& [parts, labels, classified] = reading.sorted;
  classified.welded.clear();
  classified.skipped.clear();
  std::vector<glm::vec3> wood;
  for (int32_t p = 0; p < parts.count(); ++p) {
    if (classified.role[p] == PartRole::kFoliage) continue;
    classified.role[p] = PartRole::kTube;
    for (const int32_t v : parts.part_vertices(p)) wood.push_back(scene.positions[v]);
  }
  if (wood.empty()) {
    throw std::invalid_argument(options.bones +
                                ": the mesh has no wood for its bones: give the foliage's names");
  }
  std::vector<SpeedTreeBone> bones = read_speedtree_bones(options.bones);
  std::vector<Branch> branches = branches_of_bones(bones);
  // Positions are relative to the origin of a tree that is far from its file's.
  for (Branch& branch : branches) {
    for (glm::vec3& p : branch.points) p = glm::vec3(glm::dvec3(p) - origin);
    branch.attach_point = glm::vec3(glm::dvec3(branch.attach_point) - origin);
  }
  fit_branches(wood, options.bones, branches);
  reading.traced.reversible.assign(branches.size(), 0);
  reading.traced.label.assign(branches.size(), -1);
  reading.traced.branches = std::move(branches);
  reading.traced.welded = reading.traced.named = true;
  return reading;
}

std::string percent(double share) {
  return std::to_string(static_cast<int>(std::lround(100.0 * share))) + " %";
}

/// The label with most of the area of the limbs.
std::string name_of_wood(const ObjScene& scene, const SortedParts& sorted) {
  const auto& [parts, labels, classified] = sorted;
  std::vector<double> areas(labels.names.size(), 0.0);
  for (int32_t p = 0; p < parts.count(); ++p) {
    const bool wood =
        classified.role[p] != PartRole::kFoliage && classified.role[p] != PartRole::kSkipped;
    if (wood && labels.label[p] >= 0) areas[labels.label[p]] += part_area(scene, parts, p);
  }
  const auto most = std::max_element(areas.begin(), areas.end());
  return most != areas.end() ? labels.names[static_cast<size_t>(most - areas.begin())] : "";
}

/// Says which parts the limbs do not represent, and what to do.
void report_coverage(const Reading& reading, ImportReport& report) {
  report.coverage = reading.coverage.share();
  if (report.coverage >= kLowCoverage) return;
  const auto& [parts, labels, classified] = reading.sorted;
  std::string text = "the limbs represent only " + percent(report.coverage) + " of the wood";
  for (size_t i = 0; i < std::min(reading.coverage.missing.size(), kNamedParts); ++i) {
    const auto& [part, area] = reading.coverage.missing[i];
    const std::string name =
        labels.label[part] >= 0 ? labels.names[labels.label[part]] : "(unnamed)";
    const auto skipped =
        std::find_if(classified.skipped.begin(), classified.skipped.end(),
                     [p = part](const SkippedPart& entry) { return entry.part == p; });
    text += (i == 0 ? "; missing: " : ", ") + percent(area / reading.coverage.area) + " in '" +
            name + "' (" +
            (skipped != classified.skipped.end() ? skipped->why
                                                 : "its polygons are away from its limb") +
            ")";
  }
  report.warnings.push_back(text +
                            ". Import it with Keep Original Surface, which uses its own mesh");
}

/// Fills the skeleton's foliage and report.
/// @return the wood, not yet connected.
TracedBranches read_parts(ObjScene& scene, const std::string& path, const ReadTreeOptions& options,
                          Skeleton& skeleton) {
  const base::Execution whole{options.threads, options.progress};
  ImportReport& report = skeleton.report;
  report_scene(scene, report);
  Reading reading = options.bones.empty()
                        ? read_wood(scene, options, whole.part(0.5f, 0.8f))
                        : read_with_bones(scene, options, skeleton.origin, whole.part(0.5f, 0.8f));
  const auto& [parts, labels, classified] = reading.sorted;
  report.form = options.bones.empty() ? form_name(classified.form) : "SPEEDTREE_BONES";
  report.foliage_parts = classified.foliage_count;
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(report.skipped_parts, reading.report.skipped_parts);
  append(report.warnings, reading.report.warnings);
  TracedBranches& traced = reading.traced;
  if (options.bones.empty() && options.keep_surface && !has_limbs(traced, reading.left_out)) {
    stand_as_one(scene, options.up_axis, reading);
    report.form = "ONE_LIMB";
  }
  check_branches(traced, classified.foliage_count, reading.left_out, path);
  report.wood_name = name_of_wood(scene, reading.sorted);
  report_coverage(reading, report);
  assign_levels(traced, labels, classified.form, options.levels, report.warnings);
  if (options.keep_surface) skeleton.kept = gather_kept(scene, parts, classified, traced.branches);
  if (options.bones.empty()) skeleton.wood = gather_wood(scene, parts, classified, traced.branches);
  if (options.foliage) {
    skeleton.foliage = gather_foliage(scene, parts, classified);
  } else if (classified.foliage_count > 0) {
    report.skipped_parts.emplace_back(
        "foliage (" + std::to_string(classified.foliage_count) + " parts)", "left out by option");
  }
  return std::move(traced);
}

/// Rotates wood and leaves so that Z is up.
void turn_z_up(UpAxis up_axis, TracedBranches& traced, Skeleton& skeleton) {
  const bool y_up =
      up_axis == UpAxis::kY || (up_axis == UpAxis::kAuto && grows_along_y(traced.branches));
  skeleton.report.up_axis.assign(1, y_up ? 'Y' : 'Z');
  if (!y_up) return;
  turn_y_up_to_z_up(traced.branches);
  for (glm::vec3& p : skeleton.foliage.vertices) p = y_up_to_z_up(p);
  for (glm::vec3& normal : skeleton.foliage.corner_normal) normal = y_up_to_z_up(normal);
  for (glm::vec3& p : skeleton.wood.vertices) p = y_up_to_z_up(p);
  for (glm::vec3& p : skeleton.kept.vertices) p = y_up_to_z_up(p);
  for (glm::vec3& normal : skeleton.kept.corner_normal) normal = y_up_to_z_up(normal);
  skeleton.origin = {skeleton.origin.x, -skeleton.origin.z, skeleton.origin.y};
}

/// Scales the tree to the options' size.
void scale_tree(const ReadTreeOptions& options, Skeleton& skeleton) {
  double factor = options.unit;
  if (options.height > 0.0) {
    if (!(skeleton.height > 0.0f)) {
      throw std::invalid_argument("the tree has no height, so it cannot be scaled to " +
                                  std::to_string(options.height) + " metres");
    }
    factor = options.height / static_cast<double>(skeleton.height);
  }
  scale_skeleton(skeleton, factor);
}

/// Whether branches have no names of their own in a file of this form.
bool is_merged(TreeForm form) {
  return form == TreeForm::kMergedTubes || form == TreeForm::kMaterials ||
         form == TreeForm::kMergedSquares || form == TreeForm::kWelded;
}

void report_extra_roots(Skeleton& skeleton) {
  for (size_t b = 1; b < skeleton.branches.size(); ++b) {
    const Branch& branch = skeleton.branches[b];
    if (branch.parent < 0) skeleton.report.extra_roots.push_back(branch.name);
  }
}

void check_options(const ReadTreeOptions& options) {
  check_tolerance(options.tolerance);
  if (!options.bones.empty() && !options.keep_surface) {
    throw std::invalid_argument(
        "the bones of SpeedTree are for its own mesh: turn on Keep Original Surface");
  }
  if (!(options.unit > 0.0) || !std::isfinite(options.unit) || !(options.height >= 0.0) ||
      !std::isfinite(options.height)) {
    throw std::invalid_argument("unit must be above zero metres, height zero or above");
  }
}

/// Fills the skeleton from the polygons of a file or a mesh.
void build_skeleton(ObjScene& scene, const std::string& path, const ReadTreeOptions& options,
                    Skeleton& skeleton) {
  const base::Execution whole{options.threads, options.progress};
  close_seams(scene);
  TracedBranches traced = read_parts(scene, path, options, skeleton);

  connect(traced, !options.levels.empty(), skeleton.report.warnings,
          base::part_of(options.progress, 0.8f, 0.85f));
  base::report_progress(options.progress, 0.85f);
  if (!options.keep_surface) check_tree(traced, path);
  turn_z_up(options.up_axis, traced, skeleton);
  orient_roots(traced);
  if (options.bones.empty() && is_merged(traced.form)) name_by_level(traced.branches);

  skeleton.branches = std::move(traced.branches);
  complete_skeleton(skeleton);
  report_extra_roots(skeleton);
  attach_leaves(skeleton.branches, skeleton.foliage, whole.part(0.85f, 0.98f));
  scale_tree(options, skeleton);
  attach_kept(skeleton);
  if (!skeleton.wood.triangles.empty()) {
    for (const Branch& branch : skeleton.branches) {
      skeleton.wood.centrelines.push_back(branch.points);
    }
  }
  simplify_skeleton(skeleton, options.simplify, options.tolerance);
  base::report_progress(options.progress, 1.0f);
}

}  // namespace

Skeleton read_tree(const std::string& path, const ReadTreeOptions& options) {
  check_options(options);
  Skeleton skeleton;
  ObjScene scene = read_scene(path, options, skeleton);
  build_skeleton(scene, path, options, skeleton);
  describe_materials(scene, path, options.outside_files, skeleton);
  return skeleton;
}

Skeleton read_tree(ObjScene scene, const std::vector<glm::dvec3>& positions,
                   const std::string& name, const ReadTreeOptions& options) {
  check_options(options);
  Skeleton skeleton;
  scene.positions.assign(positions.begin(), positions.end());
  if (take_origin(scene, skeleton)) {
    for (size_t v = 0; v < positions.size(); ++v) {
      scene.positions[v] = positions[v] - skeleton.origin;
    }
  }
  build_skeleton(scene, name, options, skeleton);
  return skeleton;
}

}  // namespace snowbough::tree
