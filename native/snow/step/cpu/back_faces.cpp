#include <atomic>

#include "base/parallel_for.h"
#include "snow/step/cpu/passes.h"

namespace snowbough::snow::cpu {
namespace {

/// Adds to a count shared between threads.
void add(std::vector<uint32_t>& counts, uint32_t slot, uint32_t count) {
  if (count > 0) std::atomic_ref(counts[slot]).fetch_add(count, std::memory_order_relaxed);
}

}  // namespace

void count_back_faces(Scene& scene, const Tile& tile) {
  const auto width = static_cast<size_t>(tile.with_margin().size().x);
  const glm::ivec2 own = tile.pixels.size();
  base::for_each_item(static_cast<size_t>(own.y), 16, [&](size_t y) {
    const shared::SeenPixel* row =
        scene.seen.data() + (y + shared::kTileMargin) * width + shared::kTileMargin;
    uint32_t slot = 0;
    uint32_t count = 0;
    for (int32_t x = 0; x < own.x; ++x) {
      if ((row[x].triangle & shared::kBackFace) == 0) continue;
      const uint32_t triangle = (row[x].triangle & ~shared::kBackFace) - 1;
      const uint32_t object = scene.layout.triangles[triangle].object;
      if ((object & (shared::kReceives | shared::kTwoSided)) != shared::kReceives) continue;
      if ((object & shared::kSlotBits) != slot) {
        add(scene.back_pixels, slot, count);
        slot = object & shared::kSlotBits;
        count = 0;
      }
      ++count;
    }
    add(scene.back_pixels, slot, count);
  });
}

}  // namespace snowbough::snow::cpu
