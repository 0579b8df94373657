#pragma once

#include <optional>
#include <vector>

#include "base/progress.h"
#include "tree/tubes/detail.h"
#include "tree/mesh/bones_reduce.h"
#include "tree/mesh/mesh_check.h"
#include "tree/skeleton/skeleton.h"
#include "tree/skeleton/tree_mesh.h"
#include "tree/skeleton/width.h"

namespace snowbough::tree {

struct TreeMeshOptions {
  WidthOptions width;
  /// The surface as an artist wants it: refine. Without, `lod` counts.
  std::optional<Detail> detail;
  /// 0 = the four-sided base; each level up to 4 doubles the sides.
  int lod = 0;
  bool close_root = true;
  bool close_tips = true;
  /// Pixels across the square accumulation map that the snow UVs are laid out for.
  int snow_resolution = 1024;
  /// Most bones a vertex follows, 1 to 4.
  int max_influences = 4;
  /// Threads that may share the work, the calling one included; 0 = one a core. The mesh does not
  /// depend on it.
  int threads = 0;
  base::Progress progress = {};
};

/// What the finished mesh was checked for.
struct BuildReport {
  /// check_mesh on the four-sided base; finer meshes keep its topology.
  MeshCheck check;
  /// Places where a branch leaves its parent's side, and how many of them have faces within two
  /// edges that cross each other (find_crossings).
  int32_t junctions = 0;
  int32_t crossing_junctions = 0;
};

/// Rebuilds a tree as one continuous, rigged, weighted and unwrapped quad mesh, one component a
/// root. Same input, same bytes.
///
/// @param report  receives what the mesh was checked for, which takes time; null checks nothing.
/// @throws std::invalid_argument for options out of range and for a skeleton that complete_skeleton
///   would refuse.
/// @throws Cancelled when progress says stop.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, chapter 3.
TreeMesh build_tree_mesh(const Skeleton& skeleton, const TreeMeshOptions& options = {},
                         BuildReport* report = nullptr);

}  // namespace snowbough::tree
