// Projects a triangle's corner onto the grid, snapped to 1/256 pixel, so that every tile rasterises
// the same triangle bit for bit, whatever its origin.
#include "fall_frame.h"

// Buffer textures instead of storage blocks: llvmpipe reads a whole vector at once from them.
uniform samplerBuffer positions;
uniform usamplerBuffer triangles;
uniform samplerBuffer triangle_surface;

uniform vec2 viewport_origin;
uniform float viewport_size;

/// 1 + triangle with kBackFace; the object's slot with kReceives.
flat out uvec2 visible_triangle;
/// Cosine between the triangle's normal and the way to the sky.
flat out float facing;
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

vec3 snapped(uint vertex) {
  const vec3 p = project(texelFetch(positions, int(vertex)).xyz);
  return vec3(floor(p.xy * 256.0 + 0.5) * (1.0 / 256.0), p.z);
}

void main() {
  const uint index = uint(gl_VertexID) / 3u;
  const uvec4 triangle = texelFetch(triangles, int(index));
  const vec3 a = snapped(triangle.x);
  const vec3 b = snapped(triangle.y);
  const vec3 c = snapped(triangle.z);
  const vec3 ab = b - a;
  const vec3 ac = c - a;
  const float area = ab.x * ac.y - ab.y * ac.x;
  const vec2 gradient =
      area == 0.0 ? vec2(0.0)
                  : vec2(ab.z * ac.y - ac.z * ab.y, ab.x * ac.z - ac.x * ab.z) / area;
  // The cross product of the grid's axes points to the sky: faces turned there wind anticlockwise.
  visible_triangle = uvec2((index + 1u) | (area > 0.0 ? 0u : kBackFace), triangle.w);
  facing = -dot(texelFetch(triangle_surface, int(index)).xyz, fall.direction.xyz);
  corner_gradient = vec4(a.xy, gradient);
  depth_range = vec3(a.z, min(a.z, min(b.z, c.z)), max(a.z, max(b.z, c.z)));
#ifdef WITH_ALPHA
  find_alpha(int(index), ab.xy, ac.xy, area);
#endif
  const uint corner = uint(gl_VertexID) % 3u;
  const vec3 own = corner == 0u ? a : corner == 1u ? b : c;
  gl_Position = vec4((own.xy - viewport_origin) * (2.0 / viewport_size) - 1.0, 0.0, 1.0);
}
