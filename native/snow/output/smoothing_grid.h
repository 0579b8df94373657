#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
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
  std::vector<int32_t> link_other;
  /// The link's weight as a fraction of a whole link, 0 to 1, and the closeness of its ends.
  std::vector<float> link_weight;
  std::vector<float> link_closeness;

  /// Whether a cell belongs to its 2 x 2 block, which is one cell of the next level. Empty on the
  /// last level.
  std::vector<uint8_t> joins;
  /// Cells of other charts than their block's, and the cell of the next level that they belong to
  /// instead.
  struct Reassigned {
    int32_t cell;
    int32_t parent;
  };
  std::vector<Reassigned> reassigned;
};

/// The graph over which snow moves on a map's surface: texels, and blocks of texels, with links
/// across seams like any others.
struct SmoothingGrid {
  /// 1 / m2 of every texel of the map in the rest pose; 0 without surface.
  std::vector<float> inverse_area;
  /// Level 0 has one cell per texel; each further level has one cell per 2 x 2 cells of the same
  /// chart of the level before.
  std::vector<SmoothingLevel> levels;
};

/// O(texels).
SmoothingGrid build_smoothing_grid(const TexelTable& table, const SeamTable& seams);

}  // namespace snowbough::snow
