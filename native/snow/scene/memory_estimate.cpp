#include "snow/scene/memory_estimate.h"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include "shaders/lib/snow_shared.h"

namespace snowbough::snow {
namespace {

/// Upper bound of the memory of SeamLevelling and SeamLeveller, before seams are known: by texels
/// at the rim of their chart. The layout of a cylinder takes 540 bytes per rim texel, one with
/// separate triangles 1450.
int64_t levelling_bytes(const TexelTable& table) {
  constexpr int64_t kPerRimTexel = 1536;
  int64_t count = 0;
  for (size_t i = 0; i < table.texel.size(); ++i) {
    const bool goes_on = i + 1 < table.texel.size() && table.texel[i + 1] == table.texel[i] + 1 &&
                         table.chart[i + 1] == table.chart[i];
    count += table.coverage[i] < 1.0f || !goes_on ? 1 : 0;
  }
  return kPerRimTexel * count;
}

std::string mebibytes(int64_t bytes) {
  return std::to_string((bytes + (1 << 20) - 1) >> 20);
}

}  // namespace

std::string MemoryEstimate::text() const {
  return mebibytes(total()) + " MiB (maps " + mebibytes(maps) + ", texels " + mebibytes(texels) +
         ", geometry " + mebibytes(geometry) + ", occlusion tile " + mebibytes(tile) + ", output " +
         mebibytes(output) + ", seams " + mebibytes(seams) + ", repose " + mebibytes(repose) + ")";
}

MemoryEstimate estimate_memory(const std::vector<const SceneObject*>& objects, int32_t tile_size,
                               bool with_owners) {
  constexpr int64_t kPerTexel = 4 + 4 + sizeof(shared::TexelStep);
  // Of engine CPU, which takes more: 18, and a share of a run of 32 for some eight fragments.
  // Receivers that share a texel table take 14 less there.
  constexpr int64_t kPerFragment = 18 + 4;
  MemoryEstimate estimate;
  int64_t largest_map = 0;
  std::set<const AlphaMask*> masks;                // never iterated over
  std::map<const TexelTable*, int64_t> levelling;  // never iterated over
  for (const SceneObject* object : objects) {
    const MapTopology& topology = object->description.topology;
    const auto triangles = static_cast<int64_t>(object->triangle_count());
    const int64_t vertices =
        std::max<int64_t>(static_cast<int64_t>(object->positions.size()), topology.vertex_count);
    estimate.geometry += vertices * 12 + triangles * (16 + 48 + 16 + 4);
    const ObjectAlpha& alpha = object->description.alpha;
    estimate.geometry += static_cast<int64_t>(alpha.mask.size() * sizeof(shared::AlphaTriangle));
    for (const std::shared_ptr<const AlphaMask>& mask : alpha.masks) {
      if (masks.insert(mask.get()).second) {
        estimate.geometry += mask->bytes() + static_cast<int64_t>(sizeof(shared::AlphaMaskPlace));
      }
    }
    if (!object->description.receive) {
      continue;
    }
    const int64_t map = int64_t{topology.resolution} * topology.resolution;
    largest_map = std::max(largest_map, map);
    estimate.maps += map * (with_owners ? 4 + 8 : 4);
    const auto [seams, is_new] = levelling.emplace(object->table.get(), 0);
    if (is_new) seams->second = levelling_bytes(*object->table);
    estimate.seams += seams->second;
    estimate.geometry += triangles * static_cast<int64_t>(sizeof(shared::MapTriangle));
    // At most one point per corner: its corner, its list offsets, its normal and its snow.
    const bool is_smooth = !object->description.shading.empty();
    estimate.geometry += is_smooth ? triangles * (16 + 3 * (4 + 4 + 16 + 16)) : 0;
    const int64_t group = shared::kTexelGroup;
    const int64_t texels =
        (static_cast<int64_t>(object->table->texel.size()) + group - 1) / group * group;
    estimate.texels += texels * kPerTexel + texels / group * (16 + 4 * 4) + triangles * 2 * 4 +
                       kPerFragment * static_cast<int64_t>(object->table->fragment_triangle.size());
  }
  // Seen, drawn and copied pixels; the depth buffer.
  estimate.tile =
      int64_t{tile_size} * tile_size * static_cast<int64_t>(2 * sizeof(shared::SeenPixel) + 4);
  // Two workspaces of seven arrays and the proximity to feet, a third more for the coarse levels;
  // the map, a normal, tables, and the ends of the surface.
  estimate.output = largest_map * (2 * (28 + 2) + 4 + 12 + 12 + 1);
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
