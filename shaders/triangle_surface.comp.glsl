// Normal and area of every triangle, from the current vertices.
#include "snow_shared.h"

layout(local_size_x = 64) in;
layout(std430) readonly buffer Positions { float positions[]; };
layout(std430) readonly buffer Triangles { SceneTriangle triangles[]; };
/// xyz: unit normal (0 for a triangle without area), w: area in m2.
layout(std430) writeonly buffer TriangleSurface { vec4 triangle_surface[]; };
uniform uint first;
uniform uint count;

vec3 vertex(uint index) {
  return vec3(positions[3u * index], positions[3u * index + 1u], positions[3u * index + 2u]);
}

void main() {
  if (gl_GlobalInvocationID.x >= count) {
    return;
  }
  const uint index = first + gl_GlobalInvocationID.x;
  const SceneTriangle triangle = triangles[index];
  const vec3 a = vertex(triangle.a);
  const vec3 ab = vertex(triangle.b) - a;
  const vec3 ac = vertex(triangle.c) - a;
  // Scaled before the product: the square of a micrometre's area is out of float's range.
  const float scale = max(max(abs(ab.x), max(abs(ab.y), abs(ab.z))),
                          max(abs(ac.x), max(abs(ac.y), abs(ac.z))));
  const vec3 normal = scale > 0.0 ? cross(ab / scale, ac / scale) : vec3(0.0);
  const float size = length(normal);
  triangle_surface[index] =
      size > 0.0 ? vec4(normal / size, 0.5 * size * scale * scale) : vec4(0.0);
}
