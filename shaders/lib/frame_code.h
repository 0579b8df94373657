#pragma once

// Encoding of a picture's linear light as 24 bits in the float of a one-channel texture: 0x3F000000 + red, green and
// blue of 8 bits each, red highest. As floats these are 0.5 to 2, never a NaN or denormal that a driver would change.
// An 8-bit channel holds 255 * (c / (1 + c))^(1 / 2.2): steps of about 2 % over the whole range, as in sRGB, but with
// room for light over 1, which view transforms show. addon/snowbough/realtime/frame_code.py decodes them.
#include "shared_functions.h"
#include "shared_types.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

const uint kFrameBits = 0x3F000000u;
const float kFrameGamma = 2.2f;
/// The highest byte: 255 would be infinite light.
const float kFrameHighest = 254.0f;
const float kFrameMostLight = 1e6f;

/// 0 to 1, evenly distributed over each 8 x 8 pixels: added before rounding down, so that slow gradients show no bands.
/// Source: B. E. Bayer, An Optimum Method for Two-Level Rendition of Continuous-Tone Pictures, 1973.
SNOWBOUGH_SHARED_FUNCTION float frame_dither(uint x, uint y) {
  uint rank = 0u;
  for (uint bit = 0u; bit < 3u; ++bit) {
    const uint low_x = (x >> bit) & 1u;
    const uint low_y = (y >> bit) & 1u;
    rank = rank * 4u + 2u * (low_x ^ low_y) + low_y;
  }
  return (float(rank) + 0.5f) / 64.0f;
}

SNOWBOUGH_SHARED_FUNCTION uint packed_channel(float light, float dither) {
  const float given = light > 0.0f ? min(light, kFrameMostLight) : 0.0f;
  const float share = given / (1.0f + given);
  return uint(min(floor(255.0f * pow(share, 1.0f / kFrameGamma) + dither), kFrameHighest));
}

SNOWBOUGH_SHARED_FUNCTION uint packed_light(float red, float green, float blue, float dither) {
  return kFrameBits + (packed_channel(red, dither) << 16u) + (packed_channel(green, dither) << 8u) +
         packed_channel(blue, dither);
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
