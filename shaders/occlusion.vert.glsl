// Projects a triangle's corner onto the grid and snaps it, so that every tile rasterises the same triangle bit for bit,
// independent of its origin.
#include "lib/occlusion_pixel.h"

/// See TriangleSetup.
uniform samplerBuffer triangle_corners;

uniform vec2 viewport_origin;
uniform float viewport_size;

/// A DepthPlane.
flat out uint visible_triangle;
flat out vec4 corner_gradient;
flat out vec3 depth_range;

#ifdef WITH_ALPHA
uniform usamplerBuffer alpha_triangles;
uniform usamplerBuffer alpha_headers;
/// Offset from a triangle's index to its alpha's.
uniform int alpha_offset;

/// An AlphaPlane.
flat out vec2 alpha_corner;
flat out vec4 alpha_gradient;
/// An AlphaMaskHeader; width 0 = opaque.
flat out uvec4 alpha_header;

void find_alpha(int index, vec3 a, vec3 b, vec3 c) {
  const uvec4 low = texelFetch(alpha_triangles, 2 * (index + alpha_offset));
  const uvec4 high = texelFetch(alpha_triangles, 2 * (index + alpha_offset) + 1);
  const AlphaPlane plane = alpha_plane(a, b, c, uintBitsToFloat(low.xy), uintBitsToFloat(low.zw),
                                       uintBitsToFloat(high.xy));
  alpha_corner = plane.corner;
  alpha_gradient = plane.gradient;
  alpha_header = high.z == 0u ? uvec4(0u) : texelFetch(alpha_headers, int(high.z) - 1);
}
#endif

vec3 snapped_corner(uint corner) { return snapped(texelFetch(triangle_corners, int(corner))); }

void main() {
  const uint index = uint(gl_VertexID) / 3u;
  const vec3 a = snapped_corner(3u * index);
  const vec3 b = snapped_corner(3u * index + 1u);
  const vec3 c = snapped_corner(3u * index + 2u);
  const DepthPlane plane = depth_plane(a, b, c, index);
  visible_triangle = plane.seen;
  corner_gradient = plane.corner_gradient;
  depth_range = plane.range;
#ifdef WITH_ALPHA
  find_alpha(int(index), a, b, c);
#endif
  const uint corner = uint(gl_VertexID) % 3u;
  const vec3 own = corner == 0u ? a : corner == 1u ? b : c;
  gl_Position = vec4((own.xy - viewport_origin) * (2.0 / viewport_size) - 1.0, 0.0, 1.0);
}
