#pragma once

#include <optional>

#include "base/progress.h"
#include "tree/mesh/mesh_check.h"
#include "tree/skeleton/skeleton.h"
#include "tree/skeleton/tree_mesh.h"
#include "tree/skeleton/width.h"
#include "tree/tubes/detail.h"

namespace snowbough::tree {

struct TreeMeshOptions {
  WidthOptions width;
  /// Refined surface for artists: see refine. None: the four-sided base.
  std::optional<Detail> detail;
  bool close_root = true;
  bool close_tips = true;
  /// Edge in pixels of the square accumulation map for which the snow UVs are laid out.
  int snow_resolution = 1024;
  /// Maximum number of bones that influence a vertex, 1 to 4.
  int max_influences = 4;
  /// One bone that all roots hang from: see make_bones.
  bool root_bone = true;
  /// Threads that may share the work, the calling one included; 0 = one per core. Does not change
  /// the mesh.
  int threads = 0;
  base::Progress progress = {};
};

/// Result of the checks on the finished mesh.
struct BuildReport {
  /// check_mesh on the four-sided base; finer meshes keep its topology.
  MeshCheck check;
  /// Number of junctions where a branch leaves its parent's side, and of those with intersecting
  /// faces within two edges (find_crossings).
  int32_t junctions = 0;
  int32_t crossing_junctions = 0;
};

/// Rebuilds a tree as one continuous, rigged, weighted and unwrapped quad mesh, one component per
/// root. Same input, same bytes.
/// @param report  receives the result of the mesh checks, which take time; null skips them.
/// @throws std::invalid_argument for options out of range, and as complete_skeleton.
/// @throws Cancelled when progress says stop.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, chapter 3.
TreeMesh build_tree_mesh(const Skeleton& skeleton, const TreeMeshOptions& options = {},
                         BuildReport* report = nullptr);

}  // namespace snowbough::tree
