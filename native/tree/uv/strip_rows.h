#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tree/skeleton/skeleton.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// Columns of a strip: the sides of a square ring.
inline constexpr int kStripSides = 4;

/// One side of one row: a wall, four insets around a hole, or (both -1) a hole as wide as the side.
struct StripCell {
  /// Quad of the wall.
  int32_t wall = -1;
  /// Index into Strip::insets.
  int32_t inset = -1;

  bool empty() const { return wall < 0 && inset < 0; }
};

/// The four corners of a limb between two rows, anticlockwise seen from the tip.
struct StripRing {
  /// Vertex indices; -1 if every cell around the corner is a hole.
  std::array<int32_t, 4> corners{-1, -1, -1, -1};
  /// Length in metres of the side from corner k to corner k + 1.
  std::array<float, 4> sides{};
  /// Height of corner k above the ring's centre, in metres.
  std::array<float, 4> heights{};
};

/// The cells between two rings.
struct StripRow {
  std::array<StripCell, 4> cells;
  int32_t branch = -1;
};

/// Rows [first, last).
struct RowRange {
  int32_t first = 0;
  int32_t last = 0;
};

/// A limb and the children that continue it from its end ring, as rows of one closed tube. Sides
/// are counted in the first limb's order throughout.
struct Strip {
  /// One more than rows.
  std::vector<StripRing> rings;
  std::vector<StripRow> rows;
  /// The quads around each hole, along the four edges of its cell; -1 where one is missing.
  std::vector<std::array<int32_t, 4>> insets;
  /// Perimeter of every ring in metres, and m2 of every row with its holes filled.
  std::vector<double> perimeters;
  std::vector<double> areas;
  /// Connected rows: between two ranges there are holes on all sides.
  std::vector<RowRange> ranges;
  /// Closing quads; -1 if open.
  int32_t root_cap = -1;
  int32_t tip_cap = -1;
};

/// Sorts the quads of a base mesh into strips, in the order of their first branches.
/// @throws std::invalid_argument if the origins contradict the quads.
std::vector<Strip> collect_strips(const TreeMesh& mesh, const Skeleton& skeleton);

}  // namespace snowbough::tree
