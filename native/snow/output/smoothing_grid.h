#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/seams/seam_table.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// The upper half of a float, for values that need no more precision than 1/256.
inline uint16_t rounded_half(float value) {
  return static_cast<uint16_t>((std::bit_cast<uint32_t>(value) + 0x7FFFu) >> 16);
}
inline float from_half(uint16_t half) {
  return std::bit_cast<float>(static_cast<uint32_t>(half) << 16);
}

/// One level of a SmoothingGrid: `size` x `size` cells, some of which carry surface, and the links
/// over which neighbours exchange snow. A link's closeness is 1 / distance^2 in 1/m2; 0: no link.
struct SmoothingLevel {
  int32_t size = 0;
  /// Links to the right and upper neighbour (rounded_half), after a row without links.
  std::vector<uint16_t> right;
  std::vector<uint16_t> above;
  const uint16_t* to_right() const { return right.data() + size; }
  const uint16_t* upwards() const { return above.data() + size; }

  /// Other links, across seams, stored at both ends: the links of cell link_cell[i] (ascending) are
  /// [link_begin[i], link_begin[i + 1]), and the cells of row y are [link_row[y], link_row[y + 1])
  /// of link_cell.
  std::vector<int32_t> link_cell;
  std::vector<int32_t> link_begin;
  std::vector<int32_t> link_row;
  /// One bit per cell: whether it is in link_cell.
  std::vector<uint64_t> linked;
  bool is_linked(int32_t cell) const {
    return (linked[static_cast<size_t>(cell) / 64] >> (cell % 64) & 1) != 0;
  }
  /// Calls visit(other) for a cell's links across seams.
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
  /// The link's weight as a fraction of a whole link, 0 to 1, and the closeness of its ends.
  std::vector<float> link_weight;
  std::vector<float> link_closeness;

  /// Whether a cell belongs to its 2 x 2 block, which is one cell of the next level. Empty on the
  /// last level.
  std::vector<uint8_t> joins;
  /// Cells of other charts than their block's, and the cell of the next level that they belong to
  /// instead.
  struct Stray {
    int32_t cell;
    int32_t parent;
  };
  std::vector<Stray> strays;
};

/// How the surface continues beyond a texel.
enum class SurfaceEnd : uint8_t {
  kNone,
  /// The surface ends.
  kOpen,
  /// The surface turns away: snow that ends there overhangs.
  kRim,
};

/// The graph over which snow moves on a map's surface: texels, and blocks of texels, with links
/// across seams like any others.
struct SmoothingGrid {
  /// 1 / m2 of every texel of the map in the rest pose; 0 without surface.
  std::vector<float> inverse_area;
  /// Per texel of the map.
  std::vector<SurfaceEnd> end;
  /// The texels whose end is kOpen, ascending.
  std::vector<int32_t> open_ends;
  /// Level 0 has one cell per texel; each further level has one cell per 2 x 2 cells of the same
  /// chart of the level before.
  std::vector<SmoothingLevel> levels;
};

/// `normals`: per triangle, of unit length; neighbouring texels whose normals differ by more than
/// 45 degrees form a rim. Empty: no rims. O(texels).
SmoothingGrid build_smoothing_grid(const TexelTable& table, const SeamTable& seams,
                                   const std::vector<glm::vec3>& normals = {});

}  // namespace snowbough::snow
