#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Edge in texels of the blocks into which repose divides a map.
inline constexpr int32_t kReposeBlock = 32;
/// All rows of a block, one bit each.
inline constexpr uint32_t kAllRows = 0xFFFFFFFFu;
static_assert(kReposeBlock == 32, "rows of a block are bits of a uint32_t");
inline constexpr int32_t kTileCells = kReposeBlock * kReposeBlock;

/// Offsets of the neighbours to which a texel stores its links (column and row); the other
/// neighbours store theirs to it.
inline constexpr int32_t kForwardLinks = 4;
inline constexpr int32_t kForwardColumn[kForwardLinks] = {1, 0, 1, -1};
inline constexpr int32_t kForwardRow[kForwardLinks] = {0, 1, 1, 1};
/// In ReposeLinks::forward, beside the links.
inline constexpr uint8_t kHasTexel = 32;

/// Calls visit(texel, column, row) for a map's texels, ascending, without a division for each.
template <typename Visit>
void for_each_place(const TexelTable& table, const Visit& visit) {
  int32_t row = 0;
  for (size_t i = 0; i < table.texel.size(); ++i) {
    int32_t column = table.texel[i] - row * table.resolution;
    for (; column >= table.resolution; column -= table.resolution) ++row;
    visit(static_cast<int32_t>(i), column, row);
  }
}

/// The texels that are neighbours on the surface, between which snow may move: texels side by side
/// or diagonal in one chart, texels that meet at a seam of the layout, and texels at an open edge,
/// over which snow falls into the air. Texels are indices into the TexelTable.
struct ReposeLinks {
  int32_t resolution = 0;
  int32_t blocks_a_side = 0;
  /// Per cell (cell_of): bit k is set if its texel is linked with neighbour kForwardColumn[k],
  /// kForwardRow[k]; kHasTexel, if it has a texel.
  std::vector<uint8_t> forward;
  /// Texels of row r in column b of blocks: [run_begin[r * blocks_a_side + b], next).
  std::vector<int32_t> run_begin;

  /// A point of a triangle, by the weights of its second and third corner.
  struct Point {
    int32_t triangle = 0;
    glm::vec2 weights{0.0f};
  };
  /// Two texels across a seam, a < b, and where they meet; each pair once, ascending.
  struct Across {
    int32_t a = 0;
    int32_t b = 0;
    Point seam;
    std::pair<int32_t, int32_t> ends() const { return {a, b}; }
  };
  std::vector<Across> across;
  /// A texel at an open edge, and the edge's nearest point.
  struct OpenEdge {
    int32_t texel = 0;
    Point point;
  };
  std::vector<OpenEdge> open_edges;

  /// One end of a link across a seam or over an open edge, at a texel.
  struct End {
    int32_t texel = 0;
    /// See cell_of.
    int32_t cell = 0;
    /// Index in `across`, or across.size() + index in `open_edges`.
    int32_t link = 0;
    /// The flow's sign at this end: -1 at `a` and at open edges, 1 at `b`.
    int32_t sign = 0;
    /// Number of the texel's links of all kinds.
    int32_t links = 0;
  };
  /// Ends in block b: [end_begin[b], end_begin[b + 1]).
  std::vector<int32_t> end_begin;
  std::vector<End> ends;
  /// Blocks with texels linked to block b, and b itself: [near_begin[b], near_begin[b + 1]).
  std::vector<int32_t> near_begin;
  std::vector<int32_t> near;

  /// Per link across a seam: the cells of its two ends.
  std::vector<std::array<int32_t, 2>> across_cells;

  size_t block_count() const { return end_begin.size() - 1; }
  int32_t block_of(int32_t place) const { return cell_of(place) / kTileCells; }
  /// block * kReposeBlock^2 + row * kReposeBlock + column within the block.
  int32_t cell_of(int32_t place) const { return cell_at(place % resolution, place / resolution); }
  int32_t cell_at(int32_t column, int32_t row) const {
    const int32_t block = row / kReposeBlock * blocks_a_side + column / kReposeBlock;
    return (block * kReposeBlock + row % kReposeBlock) * kReposeBlock + column % kReposeBlock;
  }
  /// The links of a block's cells, row by row.
  const uint8_t* forward_of(int32_t block) const {
    return &forward[static_cast<size_t>(block) * kTileCells];
  }
  /// Calls visit(other cell, link) for the links across seams of a cell.
  template <typename Visit>
  void for_across(int32_t cell, const Visit& visit) const {
    const int32_t* const in_block = &end_begin[static_cast<size_t>(cell / kTileCells)];
    const auto is_before = [](const End& end, int32_t at) { return end.cell < at; };
    const auto last = ends.begin() + in_block[1];
    for (auto end = std::lower_bound(ends.begin() + in_block[0], last, cell, is_before);
         end != last && end->cell == cell; ++end) {
      if (static_cast<size_t>(end->link) >= across.size()) continue;
      const auto link = static_cast<size_t>(end->link);
      visit(across_cells[link][end->sign < 0 ? 1 : 0], link);
    }
  }
  /// Calls visit(first texel, count, column within the block) for the runs of texels in consecutive
  /// columns of a block's row (0 to kReposeBlock; the last is of the block above), and in `margin`
  /// columns, 0 or 1, on either side. `places`: TexelTable::texel.
  template <typename Visit>
  void for_row_runs(int32_t block, int32_t row, int32_t margin, const std::vector<int32_t>& places,
                    const Visit& visit) const {
    const int32_t column = block % blocks_a_side;
    const int32_t on_map = block / blocks_a_side * kReposeBlock + row;
    if (on_map >= resolution) return;
    const int32_t begin = on_map * resolution + column * kReposeBlock;
    const auto place = [&](int32_t i) { return places[static_cast<size_t>(i)]; };
    const int32_t* run = &run_begin[static_cast<size_t>(on_map) * blocks_a_side + column];
    int32_t i = run[0];
    int32_t last = run[1];
    const bool has_left = margin > 0 && column > 0 && i > 0 && place(i - 1) == begin - 1;
    const bool has_right = margin > 0 && column + 1 < blocks_a_side &&
                           last < static_cast<int32_t>(places.size()) &&
                           place(last) == begin + kReposeBlock;
    i -= has_left ? 1 : 0;
    last += has_right ? 1 : 0;
    for (int32_t end = i; i < last; i = end) {
      const auto is_next = [&](int32_t k) { return place(k) == place(i) + k - i; };
      end = is_next(last - 1) ? last : i + 1;
      while (end < last && is_next(end)) ++end;
      visit(i, end - i, place(i) - begin);
    }
  }
  /// Calls visit(first texel, count, cell within the block) for the runs of a block's texels in
  /// rows whose bit is set in `rows`.
  template <typename Visit>
  void for_runs(int32_t block, const std::vector<int32_t>& places, const Visit& visit,
                uint32_t rows = kAllRows) const {
    for (int32_t row = 0; row < kReposeBlock; ++row) {
      if (((rows >> row) & 1) == 0) continue;
      for_row_runs(block, row, 0, places, [&](int32_t first, int32_t count, int32_t column) {
        visit(first, count, static_cast<size_t>(row * kReposeBlock + column));
      });
    }
  }
  /// Calls visit(texel, cell within the block) for the texels of these runs.
  template <typename Visit>
  void for_texels(int32_t block, const std::vector<int32_t>& places, const Visit& visit,
                  uint32_t rows = kAllRows) const {
    const auto visit_run = [&](int32_t first, int32_t count, size_t cell) {
      for (int32_t i = 0; i < count; ++i) visit(first + i, cell + static_cast<size_t>(i));
    };
    for_runs(block, places, visit_run, rows);
  }
};

/// Finds the links of a layout. Vertices that coincide in the pose `positions` (vertex_count of
/// them or more) count as one, so that snow does not fall into the slit of a split edge. Sheets
/// that are only adjacent on the map are not linked. O(texels + triangles log triangles).
ReposeLinks find_repose_links(const MapTopology& topology, const TexelTable& table,
                              const std::vector<glm::vec3>& positions);

/// The links of a scene's receivers: those that share a texel table, and in whose poses the same
/// vertices coincide, have equal links, found once (gain: 0.5 MB a copy). For several threads.
class ReposeLinkTables {
 public:
  /// As find_repose_links.
  std::shared_ptr<const ReposeLinks> find(const MapTopology& topology,
                                          const std::shared_ptr<const TexelTable>& table,
                                          const std::vector<glm::vec3>& positions);

 private:
  struct Known;
  std::mutex mutex_;
  std::map<const TexelTable*, std::vector<std::shared_ptr<Known>>> known_;  // never iterated over
};

}  // namespace snowbough::snow
