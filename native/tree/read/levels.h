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
  /// Per label: index into names, -1 where no name fits.
  std::vector<int32_t> cluster;
};

/// Clusters the names of branches by what they have in common before their numbers: trunk1,
/// branch1, branch2 ... make the levels trunk and branch. Level names may end in digits themselves:
/// Branch11 ... Branch112, Branch21 ... are the levels Branch1 and Branch2 if their numbers run
/// from 0 or 1 only that way.
LevelClusters cluster_labels(const std::vector<std::string>& labels);

/// Clusters labels by level names that the user gives from the trunk on, separated by commas: a
/// label belongs to the longest name that it starts with (upper and lower case are the same). The
/// names keep the user's order.
/// @throws std::invalid_argument when no label starts with any of them, or for a name that is empty
///   or stands there twice.
LevelClusters match_levels(const std::string& levels, const std::vector<std::string>& labels);

/// Ranks clusters from the trunk on: those named trunk (bole, Stamm, tronc) first, the others by
/// the mean volume of their branches; clusters whose names differ only in a trailing number keep
/// that number's order. Where the branches of one stand on those of the next rather than the other
/// way round, the two change places, however large they are. Per cluster: its level.
/// @param branch_cluster per branch.
std::vector<int32_t> rank_levels(const std::vector<std::string>& cluster_names,
                                 const std::vector<Branch>& branches,
                                 const std::vector<int32_t>& branch_cluster);

}  // namespace snowbough::tree
