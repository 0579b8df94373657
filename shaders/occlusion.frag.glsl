// What the sky sees in a pixel. Depth comes from the triangle's own plane instead of the rasteriser's
// interpolation, which depends on the tile's origin in its last bits.
#include "fall_frame.h"

uniform ivec2 tile_origin;

flat in uint visible_triangle;
flat in vec4 corner_gradient;
flat in vec3 depth_range;

/// A SeenPixel.
layout(location = 0) out uvec2 visible;

#ifdef WITH_ALPHA
uniform usamplerBuffer alpha_bits;

flat in vec2 alpha_corner;
flat in vec4 alpha_gradient;
flat in uvec4 alpha_place;

/// Whether the image lets snow through at uv: the texel that uv lies in decides.
bool is_hole(vec2 uv) {
  const uint extension = alpha_place.w;
  if (extension == kAlphaClip && (min(uv.x, uv.y) < 0.0 || max(uv.x, uv.y) > 1.0)) {
    return true;
  }
  if (extension == kAlphaRepeat) {
    uv -= floor(uv);
  } else if (extension == kAlphaMirror) {
    uv = 1.0 - abs(uv - 2.0 * floor(0.5 * uv) - 1.0);
  }
  const ivec2 size = ivec2(alpha_place.yz);
  const ivec2 texel = clamp(ivec2(clamp(uv, 0.0, 1.0) * vec2(size)), ivec2(0), size - 1);
  const uint bit = uint(texel.y * size.x + texel.x);
  const uint word = texelFetch(alpha_bits, int(alpha_place.x + (bit >> 5u))).x;
  return ((word >> (bit & 31u)) & 1u) == 0u;
}
#endif

void main() {
  const vec2 offset = gl_FragCoord.xy + vec2(tile_origin) - corner_gradient.xy;
#ifdef WITH_ALPHA
  const vec2 uv = alpha_corner + offset.x * alpha_gradient.xz + offset.y * alpha_gradient.yw;
  if (alpha_place.y != 0u && is_hole(uv)) {
    discard;
  }
#endif
  const float depth = clamp(depth_range.x + offset.x * corner_gradient.z + offset.y * corner_gradient.w,
                            depth_range.y, depth_range.z);
  gl_FragDepth = (depth - fall.range.x) * fall.range.y;
  visible = uvec2(visible_triangle, floatBitsToUint(depth));
}
