#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Texels a side of a block, in which repose goes over a map.
inline constexpr int32_t kReposeBlock = 32;

/// The neighbours of a texel on the map to which it keeps the links: those behind it in rows from
/// below keep theirs to it. Column and row, by number.
inline constexpr int32_t kForwardLinks = 4;
inline constexpr int32_t kForwardColumn[kForwardLinks] = {1, 0, 1, -1};
inline constexpr int32_t kForwardRow[kForwardLinks] = {0, 1, 1, 1};

/// Which texels of a map are neighbours on the surface, so that snow may move between them: texels
/// beside or across a corner from each other in one chart, texels that meet at a seam of the
/// layout, and texels at a rim of the surface, over which snow falls into the air. Texels are meant
/// by their index in the TexelTable.
struct ReposeLinks {
  int32_t resolution = 0;
  int32_t blocks_a_side = 0;
  /// Per texel: bit k, it is linked with its neighbour kForwardColumn[k], kForwardRow[k].
  std::vector<uint8_t> forward;
  /// Texels of row r in column b of blocks: [run_begin[r * blocks_a_side + b], next).
  std::vector<int32_t> run_begin;

  /// A point of a triangle, by the weights of its second and third corner.
  struct Point {
    int32_t triangle = 0;
    glm::vec2 weights{0.0f};
  };
  /// Two texels across a seam, a < b, and where they meet; once each, ascending.
  struct Across {
    int32_t a = 0;
    int32_t b = 0;
    Point seam;
    std::pair<int32_t, int32_t> ends() const { return {a, b}; }
  };
  std::vector<Across> across;
  /// A texel at a rim, and where the rim is nearest.
  struct Rim {
    int32_t texel = 0;
    Point point;
  };
  std::vector<Rim> rims;

  /// What ends at a texel apart from its links on the map.
  struct End {
    int32_t texel = 0;
    /// See cell_of.
    int32_t cell = 0;
    /// Index in `across`, or across.size() + index in `rims`.
    int32_t link = 0;
    /// Its sign at this end: -1 at `a` and at rims, 1 at `b`.
    int32_t sign = 0;
    /// Links of all kinds that the texel has.
    int32_t links = 0;
  };
  /// Ends in block b: [end_begin[b], end_begin[b + 1]).
  std::vector<int32_t> end_begin;
  std::vector<End> ends;
  /// Blocks with texels that share links with block b, itself included: [near_begin[b],
  /// near_begin[b + 1]).
  std::vector<int32_t> near_begin;
  std::vector<int32_t> near;

  /// Per link across: the cells of its two ends.
  std::vector<std::array<int32_t, 2>> across_cells;

  size_t block_count() const { return end_begin.size() - 1; }
  int32_t block_of(int32_t place) const {
    return place / resolution / kReposeBlock * blocks_a_side + place % resolution / kReposeBlock;
  }
  /// block * kReposeBlock^2 + row * kReposeBlock + column within the block.
  int32_t cell_of(int32_t place) const {
    return (block_of(place) * kReposeBlock + place / resolution % kReposeBlock) * kReposeBlock +
           place % resolution % kReposeBlock;
  }
  /// Calls visit(texel, cell within the block) for a block's texels; `places`: TexelTable::texel.
  template <typename Visit>
  void for_texels(int32_t block, const std::vector<int32_t>& places, const Visit& visit) const {
    for_texels(block, ~uint32_t{0}, places, visit);
  }
  /// The same for those of its rows that have a bit in `rows`.
  template <typename Visit>
  void for_texels(int32_t block, uint32_t rows, const std::vector<int32_t>& places,
                  const Visit& visit) const {
    const int32_t column = block % blocks_a_side;
    const int32_t first = block / blocks_a_side * kReposeBlock;
    for (int32_t row = first; row < std::min(first + kReposeBlock, resolution); ++row) {
      if (((rows >> (row - first)) & 1) == 0) continue;
      const int32_t* run = &run_begin[static_cast<size_t>(row) * blocks_a_side + column];
      const int32_t begin = row * resolution + column * kReposeBlock;
      for (int32_t i = run[0]; i < run[1]; ++i) {
        visit(i, static_cast<size_t>(row - first) * kReposeBlock +
                     static_cast<size_t>((places[static_cast<size_t>(i)] - begin)));
      }
    }
  }
};

/// Finds the links of a layout. Vertices that lie in one place in the pose `positions`
/// (vertex_count of them or more) count as one, so that snow does not fall into the slit of a split
/// edge. Sheets that only lie side by side on the map are not linked. O(texels + triangles log
/// triangles).
ReposeLinks find_repose_links(const MapTopology& topology, const TexelTable& table,
                              const std::vector<glm::vec3>& positions);

}  // namespace snowbough::snow
