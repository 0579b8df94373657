#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/seams/seam_table.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// The upper half of a float, for what need not be more exact than a part in 256.
inline uint16_t rounded_half(float value) {
  return static_cast<uint16_t>((std::bit_cast<uint32_t>(value) + 0x7FFFu) >> 16);
}
inline float from_half(uint16_t half) {
  return std::bit_cast<float>(static_cast<uint32_t>(half) << 16);
}

/// One level of a SmoothingGrid: `size` x `size` cells, some of which carry surface, and the links
/// over which neighbours exchange snow. A link's closeness is 1 / distance^2 in 1/m2; 0 = no link.
struct SmoothingLevel {
  int32_t size = 0;
  /// Links to the right and upper neighbour on the grid (rounded_half), after a row of none.
  std::vector<uint16_t> right;
  std::vector<uint16_t> above;
  const uint16_t* to_right() const { return right.data() + size; }
  const uint16_t* upwards() const { return above.data() + size; }

  /// Links that run elsewhere, across seams, each noted at both of its ends: those of cell
  /// link_cell[i] (ascending) are [link_begin[i], link_begin[i + 1]), and those of the cells of row
  /// y the cells [link_row[y], link_row[y + 1]) of link_cell.
  std::vector<int32_t> link_cell;
  std::vector<int32_t> link_begin;
  std::vector<int32_t> link_row;
  /// A bit a cell: whether it is in link_cell.
  std::vector<uint64_t> linked;
  bool is_linked(int32_t cell) const {
    return (linked[static_cast<size_t>(cell) / 64] >> (cell % 64) & 1) != 0;
  }
  /// Calls visit(other) for a cell's links that run elsewhere.
  template <typename Visit>
  void for_each_link(int32_t cell, const Visit& visit) const {
    if (!is_linked(cell)) return;
    const auto cells = link_cell.begin();
    const int32_t row = cell / size;
    const auto at = std::lower_bound(cells + link_row[row], cells + link_row[row + 1], cell);
    const auto k = static_cast<size_t>(at - cells);
    for (int32_t t = link_begin[k]; t < link_begin[k + 1]; ++t) visit(link_other[t]);
  }
  std::vector<int32_t> link_other;
  /// Which part of a whole link it is, 0 to 1, and how close the ends are.
  std::vector<float> link_weight;
  std::vector<float> link_closeness;

  /// Whether a cell is a part of the block of 2 x 2 cells that it lies in, which is one cell of the
  /// next level. Empty on the last level.
  std::vector<uint8_t> joins;
  /// The cells of other charts than their block's, and which cell of the next level they are a part
  /// of instead.
  struct Stray {
    int32_t cell;
    int32_t parent;
  };
  std::vector<Stray> strays;
};

/// What becomes of the surface beyond a texel.
enum class SurfaceEnd : uint8_t {
  kNone,
  /// It ends.
  kOpen,
  /// It turns away: snow that ends there hangs over.
  kRim,
};

/// How snow may move over a map's surface: a graph of texels, and of blocks of texels, in which
/// links cross the seams of the layout like any other neighbourhood.
struct SmoothingGrid {
  /// 1 / m2 of every texel of the map in the rest pose; 0 without surface.
  std::vector<float> inverse_area;
  /// Per texel of the map.
  std::vector<SurfaceEnd> end;
  /// The texels whose end is kOpen, ascending.
  std::vector<int32_t> open_ends;
  /// Level 0 has a cell a texel, each further one a cell for 2 x 2 of the one below that are of one
  /// chart.
  std::vector<SmoothingLevel> levels;
};

/// `normals`: per triangle, of unit length; where neighbouring texels' differ by more than 45
/// degrees, there is a rim. None: no rims. O(texels).
SmoothingGrid build_smoothing_grid(const TexelTable& table, const SeamTable& seams,
                                   const std::vector<glm::vec3>& normals = {});

}  // namespace snowbough::snow
