#include "snow/step/gl/memory.h"

#include <algorithm>

#include "shaders/lib/snow_shared.h"

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

}  // namespace

MemoryEstimate estimate_memory(const std::vector<const SceneObject*>& objects, int32_t tile_size) {
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
  return estimate;
}

}  // namespace snowbough::snow::gl
