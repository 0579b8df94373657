#include "snow/step/cpu/occlusion/occlusion.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "base/parallel_for.h"
#include "snow/step/cpu/occlusion/raster_bin.h"

namespace snowbough::snow::cpu {
namespace {

/// Pixels of a bin within those of the rectangle.
SeenPixels pixels_of_bin(glm::ivec2 bin, const PixelRect& pixels,
                         std::span<shared::SeenPixel> seen) {
  const glm::ivec2 offset = bin * kBinSize;
  const glm::ivec2 low = pixels.low + offset;
  const ptrdiff_t pitch = pixels.size().x;
  return {seen.data() + offset.y * pitch + offset.x, pitch,
          PixelRect{low,
                    {std::min(low.x + kBinSize, pixels.high.x),
                     std::min(low.y + kBinSize, pixels.high.y)}}};
}

}  // namespace

/// Draws the sorted draws from `first` on, over earlier ones.
void OcclusionPass::raster(const OcclusionScene& scene, const DrawList& draws, int64_t first,
                           const PixelRect& pixels, std::span<shared::SeenPixel> seen) {
  const glm::ivec2 size = bins_.size();
  const auto draw_bin = [&](size_t item) {
    const auto i = static_cast<int32_t>(item);
    const glm::ivec2 bin(i % size.x, i / size.x);
    raster_bin(scene, draws, first, bins_.draws_in(bin), pixels_of_bin(bin, pixels, seen),
               first == 0);
  };
  base::for_each_item(static_cast<size_t>(size.x * size.y), 1, draw_bin, options_.threads);
}

/// Sorts and draws [first, end), in halves if it would take too much memory at once.
void OcclusionPass::draw(const OcclusionScene& scene, const DrawList& draws, int64_t first,
                         int64_t end, const PixelRect& pixels, std::span<shared::SeenPixel> seen) {
  if (bins_.sort(
          {scene.corners, draws, first, end, pixels, options_.threads, options_.most_entries})) {
    raster(scene, draws, first, pixels, seen);
    return;
  }
  const int64_t middle = first + (end - first) / 2;
  draw(scene, draws, first, middle, pixels, seen);
  draw(scene, draws, middle, end, pixels, seen);
}

void OcclusionPass::run(const OcclusionScene& scene, const PixelRect& pixels,
                        std::span<shared::SeenPixel> seen) {
  const glm::ivec2 size = pixels.size();
  if (pixels.empty()) {
    throw std::invalid_argument("OcclusionPass: the rectangle has no pixels");
  }
  if (seen.size() != static_cast<size_t>(size.x) * static_cast<size_t>(size.y)) {
    throw std::invalid_argument("OcclusionPass: room for " + std::to_string(seen.size()) +
                                " pixels, there are " + std::to_string(size.x) + " x " +
                                std::to_string(size.y));
  }
  const DrawList draws(scene.ranges);
  draw(scene, draws, 0, draws.size(), pixels, seen);
}

}  // namespace snowbough::snow::cpu
