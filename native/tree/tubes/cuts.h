#pragma once

#include <cstdint>
#include <vector>

#include "tree/mesh/edges.h"
#include "tree/surface/surface.h"
#include "tree/tubes/detail.h"
#include "tree/tubes/limb_shape.h"
#include "tree/tubes/patch.h"
#include "tree/tubes/row_cuts.h"
#include "tree/tubes/side_counts.h"

namespace snowbough::tree {

/// The subdivision of the four-sided base: pieces of every base edge, shared by both its faces.
struct BaseCuts {
  RowCuts along;
  SideCounts across;
  /// Per base edge: the number of its pieces, and their bounds as fractions from its vertex a (the
  /// lower one), from 0 to 1.
  std::vector<int32_t> pieces;
  std::vector<std::vector<double>> edges;
  /// Per base quad: PatchCuts::plain.
  std::vector<int> face_plain;
  /// Resulting number of quads.
  int64_t quads = 0;
};

/// The pieces of a face's four edges.
PatchCuts patch_cuts(const BaseCuts& cuts, const Edges& edges, size_t face);

/// Cuts for a level of detail: sides by the limbs' thickness, rows at bends, tapers and junctions,
/// within the level's budget of faces.
BaseCuts cut_base(const Surface& surface, const Edges& edges, const std::vector<LimbShape>& shapes,
                  double height, const DetailSettings& settings);

}  // namespace snowbough::tree
