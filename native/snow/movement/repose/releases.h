#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "snow/movement/repose/ground.h"
#include "snow/movement/repose/outlets.h"

namespace snowbough::snow {

/// Ways from a cell to its neighbours on the map: to the forward neighbour k, and back from it,
/// in turn.
inline constexpr int32_t kWaysOnMap = 2 * kForwardLinks;

/// Ways over cells, each cell looked at once (gain: 23 % of a bake of a turning monkey).
/// Cells are numbered as by ReposeLinks::cell_of.
struct CellWays {
  struct Block {
    /// Rows whose cells' steepest links on the map are known, one bit each: the way there,
    /// kWaysOnMap if none leads down, and the fall along it as a part of the link's limit.
    uint32_t rows = 0;
    std::array<uint8_t, kTileCells> way;
    TilePlane steepest;
    /// The last cell of a cell's way that lies in the block; the units that go there; and those to
    /// which any go.
    std::array<int32_t, kTileCells> last;
    std::array<double, kTileCells> units;
    std::vector<int32_t> reached;
    std::vector<int32_t> passed;
  };
  std::vector<std::unique_ptr<Block>> blocks;

  Block& block_of(int32_t cell);
  int32_t last_in_block(const ReposeLinks& links, const ReposeBlocks& map, int32_t cell);
  int32_t end_of(const ReposeLinks& links, const ReposeBlocks& map, int32_t cell);
  int32_t next_cell(const ReposeLinks& links, const ReposeBlocks& map, int32_t cell);
  void collect_cuts(const ReposeLinks& links, const ReposeBlocks& map, int32_t block);
};

/// Lists what has fallen over outlets, and what was cut above them, in the chosen blocks.
std::vector<Release> collect_releases(const ReposeGround& ground, const ReposeBlocks& blocks,
                                      const std::vector<int32_t>& chosen, bool on_all_cores);

}  // namespace snowbough::snow
