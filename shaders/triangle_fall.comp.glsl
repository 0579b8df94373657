// Every triangle as the fall meets it in this step, from the current vertices.
#include "fall_frame.h"

layout(local_size_x = 64) in;
uniform samplerBuffer positions;
uniform usamplerBuffer triangles;
/// Both blocks begin at the triangle `first`; see triangle_fall.h.
layout(std430) writeonly buffer TriangleCorners { vec4 triangle_corners[]; };
layout(std430) writeonly buffer TriangleSurface { vec4 triangle_surface[]; };
uniform uint first;
uniform uint count;

/// Faces that turn nearly edge-on have slopes too steep to reckon with.
const float kLeastFacing = 1e-4;

vec3 vertex(uint index) { return texelFetch(positions, int(index)).xyz; }

void main() {
  const uint index = gl_GlobalInvocationID.x;
  if (index >= count) {
    return;
  }
  const uvec4 triangle = texelFetch(triangles, int(first + index));
  const vec3 a = vertex(triangle.x);
  const vec3 b = vertex(triangle.y);
  const vec3 c = vertex(triangle.z);
  const vec3 ab = b - a;
  const vec3 ac = c - a;
  // Scaled before the product: the square of a micrometre's area is out of float's range.
  const float scale = max(max(abs(ab.x), max(abs(ab.y), abs(ab.z))),
                          max(abs(ac.x), max(abs(ac.y), abs(ac.z))));
  vec3 normal = scale > 0.0 ? cross(ab / scale, ac / scale) : vec3(0.0);
  const float size = length(normal);
  normal = size > 0.0 ? normal / size : vec3(0.0);
  const float facing = -dot(normal, fall.direction.xyz);
  // Depth that the plane gains in one pixel along the grid's axes.
  const vec2 gradient = vec2(dot(normal, fall.grid_x.xyz), dot(normal, fall.grid_y.xyz)) *
                        (fall.direction.w * fall.direction.w / max(facing, kLeastFacing));
  triangle_corners[3u * index] = vec4(project(a), gradient.x);
  triangle_corners[3u * index + 1u] = vec4(project(b), gradient.y);
  triangle_corners[3u * index + 2u] = vec4(project(c), facing);
  triangle_surface[index] = vec4(facing, 0.5 * size * scale * scale, normal.z, 0.0);
}
