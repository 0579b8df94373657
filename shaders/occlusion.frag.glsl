// What the sky sees in a pixel. Depth comes from the triangle's own plane instead of the rasteriser's
// interpolation, which depends on the tile's origin in its last bits.
#include "fall_frame.h"

uniform ivec2 tile_origin;

flat in uint visible_triangle;
flat in vec4 corner_gradient;
flat in vec3 depth_range;

/// 1 + triangle with kBackFace, and the depth's bits; 0 = nothing.
layout(location = 0) out uvec2 visible;

void main() {
  const vec2 offset = gl_FragCoord.xy + vec2(tile_origin) - corner_gradient.xy;
  const float depth = clamp(depth_range.x + offset.x * corner_gradient.z + offset.y * corner_gradient.w,
                            depth_range.y, depth_range.z);
  gl_FragDepth = (depth - fall.range.x) * fall.range.y;
  visible = uvec2(visible_triangle, floatBitsToUint(depth));
}
