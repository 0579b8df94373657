// GLSL only: a texel's share of its pixel's snow. A share is proportional to projected area, so that
// surfaces of different slope in one pixel each get what falls on them.
#include "packed_pixel.h"
#include "snow_shared.h"

/// Snow in m3 for a pixel's area of texels.
uniform sampler2D pixel_share;

/// Thickness in metres that the pixel of `target` gives a texel of `area` m2.
float share_of(uvec2 target, float area) {
  const float volume = texelFetch(pixel_share, unpacked_pixel(target.x), 0).x;
  return volume * (float(target.y) * (1.0 / float(kPixelWeight))) / area;
}
