#include "snow/weigh_kernel.h"

#include "snow/processor_kernel.h"

namespace snowbough::snow {
namespace kernel {
namespace {

struct Weigh {
#include "shaders/texel_weigh.h"
};

SNOWBOUGH_KERNEL void weigh_group(Weigh weigh, int32_t group) {
  const auto first = group * static_cast<int32_t>(kTexelGroup);
  const uint object = weigh.texel_object(first);
  for (int32_t i = first; i < first + static_cast<int32_t>(kTexelGroup); ++i) {
    weigh.weigh_texel(i, object);
  }
}

}  // namespace
}  // namespace kernel

void weigh_on_processor(const SceneBuffers& scene, const gpu::Buffer& fall, const Tile& tile,
                        const OcclusionTarget& occlusion, TexelBatch& batch,
                        gpu::Buffer& weight_sum) {
  using gpu::BufferMap;
  const BufferMap groups(batch.active_groups);
  const BufferMap corners(scene.triangle_corners);
  const BufferMap surface(scene.triangle_surface);
  const BufferMap triangles(scene.triangles);
  const BufferMap texels(batch.texels);
  const BufferMap group_slots(batch.group_slots);
  const BufferMap fragment_begin(batch.fragment_begin);
  const BufferMap fragments(batch.fragments);
  const BufferMap visible(occlusion.visible);
  const BufferMap steps(batch.steps);
  const BufferMap sums(weight_sum);
  kernel::Weigh weigh;
  fall.read(0, sizeof weigh.fall, &weigh.fall);
  weigh.texels = texels.as<glm::uvec4>();
  weigh.triangle_corners = corners.as<glm::vec4>();
  weigh.corner_words = corners.as<shared::Number>();
  weigh.triangle_surface = surface.as<glm::vec4>();
  weigh.triangle_words = triangles.as<shared::Word>();
  weigh.group_slots = group_slots.as<shared::Word>();
  weigh.fragment_begin = fragment_begin.as<shared::Word>();
  weigh.fragments = fragments.as<glm::uvec2>();
  weigh.occlusion = visible.as<glm::uvec2>();
  weigh.texel_steps = steps.as<glm::uvec4>();
  weigh.weight_sums = sums.as<uint32_t>();
  weigh.tile_origin = tile.pixels.low;
  weigh.tile_size = tile.pixels.size();
  const auto* list = groups.as<uint32_t>();
  const auto count = static_cast<int32_t>(list[1]);
  for_each_in_parallel(count, 4, [&](int32_t i) {
    kernel::weigh_group(weigh, static_cast<int32_t>(list[shared::kGroupListBegin + i]));
  });
}

}  // namespace snowbough::snow
