#include "tree/read_tree.h"

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <map>
#include <stdexcept>

#include "tree/attach.h"
#include "tree/obj_reader.h"
#include "tree/parts.h"
#include "tree/rings.h"
#include "tree/squares.h"
#include "tree/up_axis.h"

namespace snowbough::tree {
namespace {

std::string group_name(const ObjScene& scene, const Parts& parts, int32_t part) {
  const FaceRun& run = scene.runs[parts.run[part]];
  const int32_t name = run.group >= 0 ? run.group : run.object;
  return name >= 0 ? scene.names[name] : std::string();
}

void move_limb(Limb&& limb, Branch& branch) {
  branch.points = std::move(limb.points);
  branch.radii = std::move(limb.radii);
  branch.areas = std::move(limb.areas);
}

}  // namespace

Skeleton read_tree(const std::string& path, const ReadTreeOptions& options) {
  check_tolerance(options.tolerance);
  ObjReadOptions read_options;
  read_options.buffer_size = options.buffer_size;
  if (options.progress) {
    read_options.progress = [&](float share) { return options.progress(0.6f * share); };
  }
  const ObjScene scene = read_obj_file(path, read_options);
  const Parts parts = split_parts(scene);

  Skeleton skeleton;
  std::map<std::string, std::vector<int32_t>> groups;
  std::vector<std::string> group_order;
  int32_t planes = 0;
  for (int32_t p = 0; p < parts.count(); ++p) {
    const std::string group = group_name(scene, parts, p);
    auto [found, added] = groups.try_emplace(group);
    if (added) group_order.push_back(group);
    found->second.push_back(p);
    planes += read_cross_section(scene, parts, p).has_value();
  }
  if (2 * planes > parts.count()) {
    skeleton.report.form = "SQUARES_PER_GROUP";
    for (const std::string& group : group_order) {
      std::vector<int32_t> unread;
      const auto sections = read_cross_sections(scene, parts, groups[group], unread);
      if (sections.empty()) continue;
      Branch branch;
      branch.name = group;
      branch.level = -1;
      move_limb(limb_from_cross_sections(sections), branch);
      skeleton.branches.push_back(std::move(branch));
    }
  } else {
    skeleton.report.form = "MERGED_TUBES";
    for (int32_t p = 0; p < parts.count(); ++p) {
      std::string why;
      std::optional<Limb> limb =
          trace_tube(scene, parts.part_faces(p), parts.part_vertices(p), why);
      if (!limb) {
        skeleton.report.skipped_parts.emplace_back(group_name(scene, parts, p), why);
        continue;
      }
      Branch branch;
      branch.name = "branch" + std::to_string(p);
      branch.level = -1;
      move_limb(std::move(*limb), branch);
      skeleton.branches.push_back(std::move(branch));
    }
  }
  if (skeleton.branches.empty()) throw std::invalid_argument(path + ": holds no branches");

  glm::vec3 low(std::numeric_limits<float>::max());
  glm::vec3 high(std::numeric_limits<float>::lowest());
  for (const Branch& branch : skeleton.branches) {
    for (const glm::vec3& p : branch.points) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }
  const glm::vec3 extent = high - low;
  skeleton.report.extra_roots =
      attach_branches(skeleton.branches, std::max({extent.x, extent.y, extent.z}));
  const bool y_up = options.up_axis == UpAxis::kY ||
                    (options.up_axis == UpAxis::kAuto && grows_along_y(skeleton.branches));
  skeleton.report.up_axis = y_up ? "Y" : "Z";
  if (y_up) turn_y_up_to_z_up(skeleton.branches);
  complete_skeleton(skeleton);
  simplify_skeleton(skeleton, options.simplify, options.tolerance);
  report_progress(options.progress, 1.0f);
  return skeleton;
}

}  // namespace snowbough::tree
