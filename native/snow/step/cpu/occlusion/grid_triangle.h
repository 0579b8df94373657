#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "shaders/lib/occlusion_pixel.h"
#include "snow/scene/projection.h"

namespace snowbough::snow::cpu {

/// Sub-pixel steps per pixel; corners are snapped to them.
inline constexpr int32_t kSteps = 256;
static_assert(static_cast<float>(kSteps) == shared::kStepsAPixel);
/// Clamp for local pixels, beyond every tile; floats times kSteps still fit an int32_t.
inline constexpr float kFarPixel = 4194304.0f;

/// The first pixel of a row or column whose centre is not before `step`. The last pixel is the one
/// before the first of the other end, so that a side belongs to the triangle at its right or above
/// it.
inline int32_t first_pixel_from(int32_t step) {
  return (step + kSteps / 2 - 1) >> 8;
}

/// The pixels of `tile` whose centres lie in the bounds of a triangle with these corners (of the
/// triangle set-up); empty if a corner is not finite.
inline PixelRect covered_pixels(const glm::vec4* corners, const PixelRect& tile) {
  const glm::vec4& a = corners[0];
  const glm::vec4& b = corners[1];
  const glm::vec4& c = corners[2];
  // Snapping keeps the order.
  const float bounds[4] = {std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}),
                           std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})};
  int32_t pixel[4];
  for (int k = 0; k < 4; ++k) {
    const float near = bounds[k] < -kFarPixel  ? -kFarPixel
                       : bounds[k] < kFarPixel ? bounds[k]
                                               : kFarPixel;
    pixel[k] =
        first_pixel_from(static_cast<int32_t>(std::floor(near * shared::kStepsAPixel + 0.5f)));
  }
  PixelRect covered{{std::max(pixel[0], tile.low.x), std::max(pixel[1], tile.low.y)},
                    {std::min(pixel[2], tile.high.x), std::min(pixel[3], tile.high.y)}};
  if (!std::isfinite(a.x + a.y + b.x + b.y + c.x + c.y)) covered.high = covered.low;
  return covered;
}

}  // namespace snowbough::snow::cpu
