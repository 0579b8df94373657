#include "snow/deposit_kernel.h"

#include <optional>

#include "base/parallel_for.h"
#include "snow/processor_kernel.h"

namespace snowbough::snow {
namespace kernel {
namespace {

#define WITH_OPACITY
struct Gain {
#include "shaders/texel_gain.h"
};

SNOWBOUGH_KERNEL void gather_group(Gain gain, int32_t group, int32_t map_offset) {
  const auto first = group * static_cast<int32_t>(kTexelGroup);
  for (int32_t i = first; i < first + static_cast<int32_t>(kTexelGroup); ++i) {
    gain.gather_texel(i, map_offset);
  }
}

}  // namespace
}  // namespace kernel

void deposit_on_processor(const SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                          const OcclusionTarget& occlusion, bool is_first, TexelBatch& batch) {
  using gpu::BufferMap;
  const BufferMap groups(batch.active_groups);
  const BufferMap group_slots(batch.group_slots);
  const BufferMap map_offsets(scene.map_offsets);
  const BufferMap corners(scene.triangle_corners);
  const BufferMap surface(scene.triangle_surface);
  const BufferMap sheets(scene.triangle_sheets);
  const BufferMap map_triangles(scene.map_triangles);
  const BufferMap fragment_begin(batch.fragment_begin);
  const BufferMap fragments(batch.fragments);
  std::optional<BufferMap> opacity;
  const BufferMap visible(occlusion.visible);
  const BufferMap steps(batch.steps);
  kernel::Gain gain{};
  fall.read(0, sizeof gain.fall, &gain.fall);
  gain.triangle_corners = corners.as<glm::vec4>();
  gain.triangle_surface = surface.as<glm::vec4>();
  gain.triangle_sheets = sheets.as<shared::Word>();
  gain.map_triangles = map_triangles.as<glm::vec4>();
  gain.fragment_begin = fragment_begin.as<shared::Word>();
  gain.fragments = fragments.as<glm::uvec4>();
  if (batch.fragment_opacity.id() != 0) {
    gain.fragment_opacity = opacity.emplace(batch.fragment_opacity).as<shared::Number>();
  }
  gain.occlusion = visible.as<glm::uvec2>();
  gain.texel_steps = steps.as<glm::uvec4>();
  gain.tile_origin = tile.with_margin().low;
  gain.tile_size = tile.with_margin().size();
  gain.resolution = static_cast<float>(scene.groups[static_cast<size_t>(batch.group)].resolution);
  gain.goes_on = is_first ? 0 : 1;
  const auto* list = groups.as<uint32_t>();
  const auto* slots = group_slots.as<uint32_t>();
  const auto* offsets = map_offsets.as<int32_t>();
  base::for_each_item(list[1], 4, [&](size_t i) {
    const uint32_t group = list[shared::kGroupListBegin + i];
    kernel::gather_group(gain, static_cast<int32_t>(group), offsets[slots[group]]);
  });
}

}  // namespace snowbough::snow
