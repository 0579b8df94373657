// The surface that the sky sees in a pixel. Depth comes from the triangle's plane instead of the rasteriser's
// interpolation, whose last bits depend on the tile's origin.
#include "lib/projection_frame.h"
#include "lib/occlusion_pixel.h"

uniform ivec2 tile_origin;

/// A DepthPlane.
flat in uint visible_triangle;
flat in vec4 corner_gradient;
flat in vec3 depth_range;

/// A SeenPixel.
layout(location = 0) out uvec2 visible;

#ifdef WITH_ALPHA
uniform usamplerBuffer alpha_bits;

/// An AlphaPlane and an AlphaMaskHeader.
flat in vec2 alpha_corner;
flat in vec4 alpha_gradient;
flat in uvec4 alpha_header;

bool is_cut_away(vec2 offset) {
  const AlphaMaskHeader mask =
      AlphaMaskHeader(alpha_header.x, alpha_header.y, alpha_header.z, alpha_header.w);
  const uint bit = mask_bit(alpha_uv(offset.x, offset.y, alpha_corner, alpha_gradient), mask);
  return bit == kNowhere ||
         is_hole(texelFetch(alpha_bits, int(mask.first_word + (bit >> 5u))).x, bit);
}
#endif

void main() {
  const vec2 offset = gl_FragCoord.xy + vec2(tile_origin) - corner_gradient.xy;
#ifdef WITH_ALPHA
  if (alpha_header.y != 0u && is_cut_away(offset)) {
    discard;
  }
#endif
  const float depth = depth_at(offset.x, offset.y, corner_gradient, depth_range);
  gl_FragDepth = (depth - least_depth(projection)) * one_over_depth(projection);
  visible = uvec2(visible_triangle, floatBitsToUint(depth));
}
