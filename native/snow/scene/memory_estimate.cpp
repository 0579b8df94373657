#include "snow/scene/memory_estimate.h"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include "shaders/lib/snow_shared.h"

namespace snowbough::snow {
namespace {

std::string mebibytes(int64_t bytes) {
  return std::to_string((bytes + (1 << 20) - 1) >> 20);
}

}  // namespace

std::string MemoryEstimate::text() const {
  return mebibytes(total()) + " MiB (maps " + mebibytes(maps) + ", texels " + mebibytes(texels) +
         ", geometry " + mebibytes(geometry) + ", occlusion tile " + mebibytes(tile) + ", output " +
         mebibytes(output) + ", seams " + mebibytes(seams) + ", repose " + mebibytes(repose) + ")";
}

namespace {

/// Blocks of a map that hold texels.
int64_t count_blocks(const TexelTable& table, int32_t side) {
  const int32_t resolution = table.resolution;
  const int32_t blocks_a_side = (resolution + side - 1) / side;
  std::vector<uint8_t> has_texels(
      static_cast<size_t>(blocks_a_side) * static_cast<size_t>(blocks_a_side), 0);
  for (const int32_t texel : table.texel) {
    has_texels[static_cast<size_t>(texel / resolution / side * blocks_a_side +
                                   texel % resolution / side)] = 1;
  }
  return std::count(has_texels.begin(), has_texels.end(), uint8_t{1});
}

}  // namespace

int64_t count_rim_texels(const TexelTable& table) {
  int64_t count = 0;
  for (size_t i = 0; i < table.texel.size(); ++i) {
    const bool continues = i + 1 < table.texel.size() && table.texel[i + 1] == table.texel[i] + 1 &&
                           table.chart[i + 1] == table.chart[i];
    count += table.coverage[i] < 1.0f || !continues ? 1 : 0;
  }
  return count;
}

int64_t count_blocks(const std::vector<const SceneObject*>& objects, int32_t side) {
  int64_t count = 0;
  std::map<const TexelTable*, int64_t> known;  // never iterated over
  for (const SceneObject* object : objects) {
    if (!object->description.receive) continue;
    const auto [own, is_new] = known.emplace(object->table.get(), 0);
    if (is_new) own->second = count_blocks(*object->table, side);
    count += own->second;
  }
  return count;
}

MemoryEstimate estimate_shared_memory(const std::vector<const SceneObject*>& objects) {
  // Upper bound of SeamLevelling and SeamLeveller, before seams are known. The layout of a cylinder
  // takes 540 bytes per rim texel, one with separate triangles 1450.
  constexpr int64_t kPerRimTexel = 1536;
  MemoryEstimate estimate;
  int64_t largest_map = 0;
  std::set<const AlphaMask*> masks;            // never iterated over
  std::map<const TexelTable*, int64_t> known;  // never iterated over
  const bool is_smooth = std::any_of(objects.begin(), objects.end(), [](const auto* object) {
    return object->description.receive && !object->description.shading.empty();
  });
  for (const SceneObject* object : objects) {
    const MapTopology& topology = object->description.topology;
    const auto triangles = static_cast<int64_t>(object->triangle_count());
    const int64_t vertices =
        std::max<int64_t>(static_cast<int64_t>(object->positions.size()), topology.vertex_count);
    // See SceneLayout; smooth points add 16 bytes per triangle.
    estimate.geometry += vertices * 12 + triangles * (16 + 48 + 16 + 4 + (is_smooth ? 16 : 0));
    const ObjectAlpha& alpha = object->description.alpha;
    estimate.geometry += static_cast<int64_t>(alpha.mask.size() * sizeof(shared::AlphaTriangle));
    for (const std::shared_ptr<const AlphaMask>& mask : alpha.masks) {
      if (masks.insert(mask.get()).second) {
        estimate.geometry += mask->bytes() + static_cast<int64_t>(sizeof(shared::AlphaMaskHeader));
      }
    }
    if (!object->description.receive) {
      continue;
    }
    const int64_t map = int64_t{topology.resolution} * topology.resolution;
    largest_map = std::max(largest_map, map);
    estimate.maps += map * 4;
    const auto [rim_texels, is_new] = known.emplace(object->table.get(), 0);
    if (is_new) rim_texels->second = count_rim_texels(*object->table);
    estimate.seams += kPerRimTexel * rim_texels->second;
    estimate.geometry += triangles * static_cast<int64_t>(sizeof(shared::MapTriangle));
    // At most one point per corner: its corner, its list offsets, its normal and its snow.
    const auto corners = static_cast<int64_t>(object->description.shading.size());
    estimate.geometry += corners * (4 + 4 + 16 + 16);
  }
  // Two workspaces of six arrays, a third more for the coarse levels;
  // the map, a normal, and tables.
  estimate.output = largest_map * (2 * 28 + 4 + 12 + 12);
  return estimate;
}

void require_memory(const MemoryEstimate& estimate, int64_t available) {
  if (available > 0 && estimate.total() > available) {
    throw std::runtime_error(
        "the snow needs " + estimate.text() + ", and " + mebibytes(available) +
        " MiB are free: lower the resolution of the largest receivers (half the "
        "resolution takes a quarter), or bake the receivers in several runs");
  }
}

}  // namespace snowbough::snow
