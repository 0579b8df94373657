#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "shaders/lib/snow_shared.h"
#include "snow/scene/projection.h"
#include "snow/step/cpu/occlusion/occlusion_scene.h"

namespace snowbough::snow::cpu {

/// Pixels to draw into.
struct SeenPixels {
  /// Pixel at `rect`'s lower left; rows are `pitch` elements apart.
  shared::SeenPixel* first;
  ptrdiff_t pitch;
  PixelRect rect;
};

/// Draws `numbers`, ascending and counted from `first_draw`, into the pixels of one bin.
/// `is_blank`: the pixels are uninitialised; otherwise drawing adds to their content.
void raster_bin(const OcclusionScene& scene, const DrawList& draws, int64_t first_draw,
                std::span<const uint32_t> numbers, const SeenPixels& pixels, bool is_blank);

}  // namespace snowbough::snow::cpu
