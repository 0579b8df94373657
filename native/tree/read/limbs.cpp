#include "tree/read/limbs.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "tree/read/levels.h"
#include "tree/rings/squares.h"

namespace snowbough::tree {
namespace {

/// @param part  of the file, or the first of the limb's planes.
void add_limb(Limb&& limb, int32_t label, int32_t part, TracedBranches& traced) {
  Branch branch;
  branch.level = -1;
  branch.piece = part;
  branch.points = std::move(limb.points);
  branch.radii = std::move(limb.radii);
  branch.areas = std::move(limb.areas);
  traced.branches.push_back(std::move(branch));
  traced.reversible.push_back(limb.reversible ? 1 : 0);
  traced.label.push_back(label);
}

void add_welded(WeldedTree&& tree, int32_t label, int32_t part, TracedBranches& traced) {
  const auto first = static_cast<int32_t>(traced.branches.size());
  for (size_t i = 0; i < tree.limbs.size(); ++i) {
    add_limb(std::move(tree.limbs[i]), label, part, traced);
    traced.branches.back().limb = static_cast<int32_t>(i);
    if (tree.parent[i] < 0) continue;
    traced.branches.back().parent = first + tree.parent[i];
    traced.branches.back().attach_point = tree.attach_point[i];
  }
  traced.welded = true;
}

/// Converts one label's planes, in file order, to one row or several.
void add_rows(const ObjScene& scene, const Parts& parts, std::span<const int32_t> group,
              int32_t label, bool one_row, TracedBranches& traced) {
  std::vector<int32_t> unread;
  const std::vector<CrossSection> sections = read_cross_sections(scene, parts, group, unread);
  if (sections.empty()) return;
  std::vector<size_t> rows = one_row ? std::vector<size_t>{0} : chain_cross_sections(sections);
  rows.push_back(sections.size());
  for (size_t r = 0; r + 1 < rows.size(); ++r) {
    const std::span<const CrossSection> row(sections.data() + rows[r], rows[r + 1] - rows[r]);
    add_limb(limb_from_cross_sections(row), label, group.front(), traced);
  }
}

/// Uses the label itself if it has one branch, numbered if it has several.
void name_branches(const PartLabels& labels, TracedBranches& traced) {
  std::vector<int32_t> members(labels.names.size() + 1, 0);
  for (const int32_t label : traced.label) ++members[label + 1];
  std::vector<int32_t> number(members.size(), 0);
  for (size_t b = 0; b < traced.branches.size(); ++b) {
    const int32_t label = traced.label[b];
    const std::string name = label >= 0 ? labels.names[label] : "branch";
    const int32_t n = ++number[label + 1];
    traced.branches[b].name = members[label + 1] == 1 ? name : name + "_" + std::to_string(n);
  }
}

}  // namespace

TracedBranches trace_branches(const ObjScene& scene, const Parts& parts, const PartLabels& labels,
                              ClassifiedParts& classified) {
  TracedBranches traced;
  std::map<int32_t, std::vector<int32_t>> rows;
  for (int32_t p = 0; p < parts.count(); ++p) {
    if (classified.role[p] == PartRole::kCrossSection) rows[labels.label[p]].push_back(p);
  }
  for (int32_t p = 0; p < parts.count(); ++p) {
    if (classified.role[p] == PartRole::kTube) {
      add_limb(std::move(classified.limbs[classified.limb[p]]), labels.label[p], p, traced);
    } else if (classified.role[p] == PartRole::kWelded) {
      const auto welded =
          std::lower_bound(classified.welded.begin(), classified.welded.end(), p,
                           [](const auto& entry, int32_t part) { return entry.first < part; });
      add_welded(std::move(welded->second), labels.label[p], p, traced);
    } else if (classified.role[p] == PartRole::kCrossSection) {
      const std::vector<int32_t>& group = rows[labels.label[p]];
      if (group.front() != p) continue;
      add_rows(scene, parts, group, labels.label[p], classified.form != TreeForm::kMergedSquares,
               traced);
    }
  }
  name_branches(labels, traced);
  return traced;
}

void assign_levels(TracedBranches& traced, const PartLabels& labels, TreeForm form,
                   const std::string& levels, std::vector<std::string>& warnings) {
  // Only labels with wood matter.
  std::vector<int32_t> number(labels.names.size(), -1);
  std::vector<std::string> names;
  bool unlabelled = false;
  for (const int32_t label : traced.label) {
    if (label < 0) {
      unlabelled = true;
    } else if (number[label] < 0) {
      number[label] = static_cast<int32_t>(names.size());
      names.push_back(labels.names[label]);
    }
  }
  if (!levels.empty()) {
    const LevelClusters clusters = match_levels(levels, names);
    const auto deepest = static_cast<int32_t>(clusters.names.size()) - 1;
    int32_t unmatched = 0;
    for (size_t b = 0; b < traced.branches.size(); ++b) {
      const int32_t label = traced.label[b];
      const int32_t level = label >= 0 ? clusters.cluster[number[label]] : -1;
      unmatched += level < 0 ? 1 : 0;
      traced.branches[b].level = level >= 0 ? level : deepest;
    }
    if (unmatched > 0) {
      warnings.push_back(std::to_string(unmatched) +
                         " branches match no level name and were put on the last level");
    }
    return;
  }

  if (unlabelled || traced.welded) return;
  LevelClusters clusters;
  const bool group_is_branch =
      form == TreeForm::kSquaresPerGroup || form == TreeForm::kTubesPerGroup;
  if (group_is_branch) {
    clusters = cluster_labels(names);
  } else {
    clusters.names = names;
    for (size_t i = 0; i < names.size(); ++i) clusters.cluster.push_back(static_cast<int32_t>(i));
  }
  const size_t count = clusters.names.size();
  const bool tell_levels = group_is_branch ? count >= 2 && count < names.size() &&
                                                 (count <= 12 || count * 3 <= names.size())
                                           : count >= 2 && count <= 12;
  if (!tell_levels) return;
  std::vector<int32_t> branch_cluster;
  for (const int32_t label : traced.label) {
    branch_cluster.push_back(clusters.cluster[number[label]]);
  }
  const std::vector<int32_t> level = rank_levels(clusters.names, traced.branches, branch_cluster);
  for (size_t b = 0; b < traced.branches.size(); ++b) {
    traced.branches[b].level = level[branch_cluster[b]];
  }
}

}  // namespace snowbough::tree
