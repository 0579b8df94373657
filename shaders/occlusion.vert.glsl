// Projects a triangle's corner onto the grid, snapped to 1/256 pixel, so that every tile rasterises
// the same triangle bit for bit, whatever its origin.
#include "snow_shared.h"

/// See triangle_fall.h.
uniform samplerBuffer triangle_corners;

uniform vec2 viewport_origin;
uniform float viewport_size;

/// 1 + triangle with kBackFace.
flat out uint visible_triangle;
/// First corner in local pixels, and the gradient of depth.
flat out vec4 corner_gradient;
/// Depth at the first corner, smallest and largest depth.
flat out vec3 depth_range;

#ifdef WITH_ALPHA
uniform usamplerBuffer alpha_triangles;
uniform usamplerBuffer alpha_places;
/// From a triangle's index to that of its alpha.
uniform int alpha_offset;

/// First corner in the image, and the gradient of u (xy) and v (zw) over local pixels.
flat out vec2 alpha_corner;
flat out vec4 alpha_gradient;
/// An AlphaMaskPlace; width 0 = opaque.
flat out uvec4 alpha_place;

void find_alpha(int index, vec2 ab, vec2 ac, float area) {
  const uvec4 low = texelFetch(alpha_triangles, 2 * (index + alpha_offset));
  const uvec4 high = texelFetch(alpha_triangles, 2 * (index + alpha_offset) + 1);
  alpha_corner = uintBitsToFloat(low.xy);
  const vec2 uv_ab = uintBitsToFloat(low.zw) - alpha_corner;
  const vec2 uv_ac = uintBitsToFloat(high.xy) - alpha_corner;
  const vec4 across = vec4(uv_ab.x * ac.y - uv_ac.x * ab.y, ab.x * uv_ac.x - ac.x * uv_ab.x,
                           uv_ab.y * ac.y - uv_ac.y * ab.y, ab.x * uv_ac.y - ac.x * uv_ab.y);
  alpha_gradient = area == 0.0 ? vec4(0.0) : across / area;
  alpha_place = high.z == 0u ? uvec4(0u) : texelFetch(alpha_places, int(high.z) - 1);
}
#endif

vec3 snapped(uint corner) {
  const vec3 p = texelFetch(triangle_corners, int(corner)).xyz;
  return vec3(floor(p.xy * 256.0 + 0.5) * (1.0 / 256.0), p.z);
}

void main() {
  const uint index = uint(gl_VertexID) / 3u;
  const vec3 a = snapped(3u * index);
  const vec3 b = snapped(3u * index + 1u);
  const vec3 c = snapped(3u * index + 2u);
  const vec3 ab = b - a;
  const vec3 ac = c - a;
  const float area = ab.x * ac.y - ab.y * ac.x;
  const vec2 gradient =
      area == 0.0 ? vec2(0.0)
                  : vec2(ab.z * ac.y - ac.z * ab.y, ab.x * ac.z - ac.x * ab.z) / area;
  // The cross product of the grid's axes points to the sky: faces turned there wind anticlockwise.
  visible_triangle = (index + 1u) | (area > 0.0 ? 0u : kBackFace);
  corner_gradient = vec4(a.xy, gradient);
  depth_range = vec3(a.z, min(a.z, min(b.z, c.z)), max(a.z, max(b.z, c.z)));
#ifdef WITH_ALPHA
  find_alpha(int(index), ab.xy, ac.xy, area);
#endif
  const uint corner = uint(gl_VertexID) % 3u;
  const vec3 own = corner == 0u ? a : corner == 1u ? b : c;
  gl_Position = vec4((own.xy - viewport_origin) * (2.0 / viewport_size) - 1.0, 0.0, 1.0);
}
