#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/output/map_tiles.h"
#include "snow/seams/seam_table.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Extends a map beyond its charts by kDilation texels with the heights of the adjacent surface, so
/// that interpolation at a seam reads the same heights from both sides.
class MapContinuation {
 public:
  /// Keeps no references.
  MapContinuation(const TexelTable& table, const SeamTable& seams);

  /// @param map resolution^2 heights, row 0 = v 0, 0 beyond the charts; changed in place.
  /// @param filled per tile (see MapTiles) whether its charts may hold anything but 0.
  void run(std::vector<float>& map, const std::vector<uint8_t>& filled) const;

 private:
  /// The texels to fill, tile by tile, and the start of each tile.
  std::vector<int32_t> begin_;
  std::vector<int32_t> texel_;
  /// The sum that each texel receives: sources are linear indices of the map's texels.
  WeightedRows rows_;
  TileReads reads_;
};

/// Expands normals per owned texel to the whole map, extended with the nearest texel's normal,
/// since the surface beyond a seam has another tangent space; (0, 0, 1) elsewhere.
std::vector<glm::vec3> dilate_normals(const TexelTable& table, const SeamTable& seams,
                                      const std::vector<glm::vec3>& normals);

}  // namespace snowbough::snow
