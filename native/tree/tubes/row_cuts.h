#pragma once

#include <vector>

#include "tree/surface/surface.h"
#include "tree/tubes/detail.h"
#include "tree/tubes/limb_shape.h"
#include "tree/tubes/row_turns.h"
#include "tree/tubes/side_counts.h"

namespace snowbough::tree {

/// The cuts of all limbs' rows along the limb.
struct RowCuts {
  /// Per limb and row: fractions of the row at its lines, from 0 to 1.
  std::vector<std::vector<std::vector<double>>> rows;
  /// Per limb and row: number of strips, from the end with fewer quads across, before the number
  /// changes.
  std::vector<std::vector<int>> plain;

  int strips(size_t limb, size_t row) const { return static_cast<int>(rows[limb][row].size()) - 1; }
};

/// Number of pieces of one side of a hole, from its corner `side` to the next.
int hole_side(const Junction& junction, int side, const SideCounts& across, const RowCuts& cuts);

/// Cuts rows at bends, tapers and junctions; knuckles evenly, into a power of two pieces.
///
/// @param turns  per limb and row, from row_turns.
RowCuts cut_rows(const Surface& surface, const LimbHoles& holes,
                 const std::vector<LimbShape>& shapes,
                 const std::vector<std::vector<RowSamples>>& turns, const SideCounts& across,
                 const DetailSettings& settings);

}  // namespace snowbough::tree
