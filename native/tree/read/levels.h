#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Labels gathered under level names.
struct LevelClusters {
  /// Level names in the order of their first label.
  std::vector<std::string> names;
  /// Per label: index into names, -1 if no name matches.
  std::vector<int32_t> cluster;
};

/// Clusters branch names by their common prefix before the number: trunk1, branch1, branch2 ...
/// give the levels trunk and branch. Level names may end in digits: Branch11 ... Branch112,
/// Branch21 ... are the levels Branch1 and Branch2 if only then their numbers start at 0 or 1
/// without gaps.
LevelClusters cluster_labels(const std::vector<std::string>& labels);

/// Clusters labels by the user's level names from the trunk on, separated by commas: a label
/// belongs to the longest name that it starts with (ignoring case). The names keep the user's
/// order.
/// @throws std::invalid_argument if no label matches any of them, or for an empty or repeated name.
LevelClusters match_levels(const std::string& levels, const std::vector<std::string>& labels);

/// Ranks clusters from the trunk on: names that mean trunk (bole, Stamm, tronc) first, the others
/// by the mean volume of their branches; clusters whose names differ only in a trailing number keep
/// that number's order. If the branches of one cluster grow on those of the next rather than the
/// reverse, the two are swapped regardless of size. Returns each cluster's level.
/// @param branch_cluster per branch.
std::vector<int32_t> rank_levels(const std::vector<std::string>& cluster_names,
                                 const std::vector<Branch>& branches,
                                 const std::vector<int32_t>& branch_cluster);

}  // namespace snowbough::tree
