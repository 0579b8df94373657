// What the sky sees in a pixel. Depth comes from the triangle's own plane instead of the rasteriser's
// interpolation, which depends on the tile's origin in its last bits.
#include "fall_frame.h"

uniform ivec2 tile_origin;

flat in uvec2 visible_triangle;
flat in float facing;
flat in vec4 corner_gradient;
flat in vec3 depth_range;

/// x: 1 + triangle with kBackFace, 0 = nothing; y: bits of the depth; z: slot with kReceives; w: bits
/// of the facing.
layout(location = 0) out uvec4 visible;

void main() {
  const vec2 offset = gl_FragCoord.xy + vec2(tile_origin) - corner_gradient.xy;
  const float depth = clamp(depth_range.x + offset.x * corner_gradient.z + offset.y * corner_gradient.w,
                            depth_range.y, depth_range.z);
  gl_FragDepth = (depth - fall.range.x) * fall.range.y;
  visible = uvec4(visible_triangle.x, floatBitsToUint(depth), visible_triangle.y,
                  floatBitsToUint(facing));
}
