#include "snow/pixels_kernel.h"

#include <algorithm>
#include <vector>

#include "snow/processor_kernel.h"

namespace snowbough::snow {
namespace kernel {
namespace {

struct Pixels {
#include "shaders/packed_pixel.h"
#include "shaders/pixel_look.h"

  /// Slots of the objects whose maps are in the group: [first, end).
  uvec2 group_objects;
  PixelCounts* counts;
  Kept<uint> last_object;
};

void flush(Pixels& pixels, uint slot, PixelCounts& count) {
  PixelCounts& sum = pixels.counts[slot];
  atomicAdd(sum.visible, count.visible);
  atomicAdd(sum.back_facing, count.back_facing);
  atomicAdd(sum.snowed, count.snowed);
  count = {};
}

/// Counts a row's pixels and adds those that are bare to `list`.
SNOWBOUGH_KERNEL void look_at_row(Pixels pixels, int32_t y, std::vector<uint>& list) {
  uint slot = pixels.group_objects.x;
  PixelCounts count{};
  const uvec2* row = pixels.occlusion + pixels.pixel_index({0, y});
  for (int32_t x = 0; x < pixels.tile_size.x; ++x) {
    const uint seen = row[x].x;
    if (seen == 0u) continue;
    const uint triangle = (seen & ~kBackFace) - 1u;
    const uint object =
        pixels.last_object.get({triangle, 0u}, [&] { return pixels.object_of(triangle); });
    const uint own = object & ~kReceives;
    if (own == object || own < pixels.group_objects.x || own >= pixels.group_objects.y) continue;
    if (own != slot) {
      flush(pixels, slot, count);
      slot = own;
    }
    if ((seen & kBackFace) != 0u) {
      ++count.back_facing;
      continue;
    }
    ++count.visible;
    const ivec2 pixel(x, y);
    if (!pixels.gives_snow(pixel)) continue;
    ++count.snowed;
    if (pixels.is_bare(pixel)) list.push_back(pixels.packed_pixel(pixel));
  }
  flush(pixels, slot, count);
}

}  // namespace
}  // namespace kernel

void list_pixels_on_processor(SceneBuffers& scene, const MapGroup& group, const gpu::Buffer& fall,
                              const Tile& tile, const OcclusionTarget& occlusion,
                              const gpu::Buffer& weight_sum, gpu::Buffer& list_size,
                              gpu::Buffer& list) {
  using gpu::BufferMap;
  const BufferMap visible(occlusion.visible);
  const BufferMap weights(weight_sum);
  const BufferMap triangles(scene.triangles);
  const BufferMap counts(scene.pixel_counts);
  const BufferMap size_map(list_size);
  const BufferMap list_map(list);
  kernel::Pixels pixels{};
  fall.read(0, sizeof pixels.fall, &pixels.fall);
  pixels.occlusion = visible.as<glm::uvec2>();
  pixels.weight_sum = weights.as<shared::Word>();
  pixels.triangle_words = triangles.as<shared::Word>();
  pixels.tile_origin = tile.pixels.low;
  pixels.tile_size = tile.pixels.size();
  pixels.group_objects = {group.first_slot, group.end_slot};
  pixels.counts = counts.as<shared::PixelCounts>();
  auto& size = *size_map.as<shared::ListSize>();
  size = {0, 1, 1, 0};
  for_each_in_parallel(pixels.tile_size.y, 8, [&](int32_t y) {
    thread_local std::vector<uint32_t> bare;
    bare.clear();
    kernel::look_at_row(pixels, y, bare);
    const uint32_t at = kernel::atomicAdd(size.count, static_cast<uint32_t>(bare.size()));
    std::copy(bare.begin(), bare.end(), list_map.as<uint32_t>() + at);
  });
  size.groups_x = std::min((size.count + shared::kBlock - 1) / shared::kBlock, shared::kMostGroups);
}

}  // namespace snowbough::snow
