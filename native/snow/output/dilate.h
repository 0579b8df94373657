#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/output/map_tiles.h"
#include "snow/seams/seam_table.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Continues a map beyond its charts by kDilation texels with what lies there on the surface, so
/// that interpolation at a seam meets the same heights from both sides.
class MapContinuation {
 public:
  /// Keeps no reference to them.
  MapContinuation(const TexelTable& table, const SeamTable& seams);

  /// @param map resolution^2 heights, row 0 = v 0, 0 beyond the charts; changed in place.
  /// @param filled per tile (see MapTiles) whether anything but 0 may lie on its charts.
  void run(std::vector<float>& map, const std::vector<uint8_t>& filled) const;

 private:
  /// The texels to fill in, tile by tile, and where each tile begins.
  std::vector<int32_t> begin_;
  std::vector<int32_t> texel_;
  /// What each shows: sources are texels of the map, by linear index.
  WeightedRows rows_;
  TileReads reads_;
};

/// The whole map of normals from one an owned texel, continued with the nearest texel's, since the
/// surface beyond a seam has another tangent space; (0, 0, 1) elsewhere.
std::vector<glm::vec3> dilate_normals(const TexelTable& table, const SeamTable& seams,
                                      const std::vector<glm::vec3>& normals);

}  // namespace snowbough::snow
