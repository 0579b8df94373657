#include "snow/output/dilate.h"

#include <numeric>

namespace snowbough::snow {

MapContinuation::MapContinuation(const TexelTable& table, const SeamTable& seams) {
  const MapTiles tiles(table.resolution);
  std::vector<int32_t> order(seams.dilated.size());
  std::iota(order.begin(), order.end(), 0);
  order = sorted_by_tile(
      order, tiles.count(), [&](int32_t row) { return tiles.of(seams.dilated[row]); }, begin_);
  const WeightedRows& rows = seams.dilated_rows;
  texel_.reserve(order.size());
  rows_.begin.reserve(rows.begin.size());
  rows_.source.reserve(rows.source.size());
  rows_.weight.reserve(rows.weight.size());
  reads_ = TileReads(tiles.count());
  for (int32_t tile = 0; tile < tiles.count(); ++tile) {
    reads_.begin_tile();
    for (int32_t i = begin_[tile]; i < begin_[tile + 1]; ++i) {
      const int32_t row = order[i];
      texel_.push_back(seams.dilated[row]);
      for (int32_t t = rows.begin[row]; t < rows.begin[row + 1]; ++t) {
        rows_.source.push_back(table.texel[rows.source[t]]);
        rows_.weight.push_back(rows.weight[t]);
        reads_.note(tiles.of(rows_.source.back()));
      }
      rows_.begin.push_back(static_cast<int32_t>(rows_.source.size()));
    }
  }
}

void MapContinuation::run(std::vector<float>& map, const std::vector<uint8_t>& filled) const {
  for (int32_t tile = 0; tile + 1 < static_cast<int32_t>(begin_.size()); ++tile) {
    if (begin_[tile] == begin_[tile + 1] || !reads_.reads_filled(tile, filled)) continue;
    for (int32_t row = begin_[tile]; row < begin_[tile + 1]; ++row) {
      map[texel_[row]] = rows_.sum(static_cast<size_t>(row), map);
    }
  }
}

std::vector<glm::vec3> dilate_normals(const TexelTable& table, const SeamTable& seams,
                                      const std::vector<glm::vec3>& normals) {
  std::vector<glm::vec3> map(static_cast<size_t>(table.resolution) * table.resolution,
                             glm::vec3(0.0f, 0.0f, 1.0f));
  for (size_t i = 0; i < table.texel.size(); ++i) map[table.texel[i]] = normals[i];
  for (size_t r = 0; r < seams.dilated.size(); ++r) {
    map[seams.dilated[r]] = normals[seams.dilated_nearest[r]];
  }
  return map;
}

}  // namespace snowbough::snow
