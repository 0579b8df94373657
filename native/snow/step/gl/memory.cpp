#include "snow/step/gl/memory.h"

#include <algorithm>

#include "shaders/lib/repose_shared.h"

namespace snowbough::snow::gl {
namespace {

/// See TexelBatch.
int64_t texel_bytes(const SceneObject& object, bool has_opacity) {
  constexpr int64_t kPerTexel = 4 + 4 + sizeof(shared::TexelStep);
  constexpr int64_t kPerGroup = shared::kMaxLocalSize * 16 + 4 * 4;
  const int64_t group = shared::kTexelGroup;
  const auto texels = static_cast<int64_t>(object.table->texel.size());
  const int64_t groups = (texels + group - 1) / group;
  const auto fragments = static_cast<int64_t>(object.table->fragment_triangle.size());
  // A group lists each of its triangles once.
  const int64_t listed = std::min(fragments, 2 * (object.triangle_count() + groups));
  return groups * (group * kPerTexel + kPerGroup) + 4 * listed +
         fragments * static_cast<int64_t>(sizeof(shared::Fragment) + (has_opacity ? 4 : 0));
}

/// See ReposeBuffers: 4 vectors, 7 numbers and two vectors per cell; tables of the block. Ends are
/// known once links are: about three per rim texel.
int64_t repose_bytes(const std::vector<const SceneObject*>& objects) {
  constexpr int64_t kPerBlock = shared::kReposeCells * (4 * 16 + 6 * 4 + 2 * 16) +
                                sizeof(shared::ReposeBlock) + sizeof(shared::ReposeBlockState) +
                                (9 + 1 + 12) * 4 + 8 + 4 * 4;
  constexpr int64_t kPerEnd = sizeof(shared::ReposeEnd) + 16 + 2 * 4;
  int64_t bytes = kPerBlock * count_blocks(objects, shared::kReposeBlock);
  for (const SceneObject* object : objects) {
    if (object->description.receive) bytes += 3 * kPerEnd * count_rim_texels(*object->table);
  }
  return bytes;
}

}  // namespace

MemoryEstimate estimate_memory(const std::vector<const SceneObject*>& objects, int32_t tile_size,
                               bool moves_snow) {
  MemoryEstimate estimate = estimate_shared_memory(objects);
  const bool has_opacity = std::any_of(objects.begin(), objects.end(), [](const auto* object) {
    return !object->fragment_opacity.empty();
  });
  for (const SceneObject* object : objects) {
    estimate.geometry += static_cast<int64_t>(sizeof(shared::ObjectSums)) + 4 + 4;
    if (object->description.receive) estimate.texels += texel_bytes(*object, has_opacity);
  }
  // See OcclusionTarget: the drawn pixels and their depths, and a copy of the pixels.
  const int64_t shown = tile_size + 2 * shared::kTileMargin;
  const int64_t drawn = (shown + 127) / 128 * 128;
  const auto pixel = static_cast<int64_t>(sizeof(shared::SeenPixel));
  estimate.tile = drawn * drawn * (pixel + 4) + shown * shown * pixel;
  if (moves_snow) estimate.repose = repose_bytes(objects);
  return estimate;
}

}  // namespace snowbough::snow::gl
