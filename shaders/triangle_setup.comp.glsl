// Evaluates every triangle as seen along this step's fall, from the current vertices.
#include "lib/projection_frame.h"
#include "lib/triangle_setup.h"

layout(local_size_x = 64) in;
uniform samplerBuffer positions;
uniform usamplerBuffer triangles;
/// Both blocks begin at the triangle `first`; see TriangleSetup.
layout(std430) writeonly buffer TriangleCorners { vec4 triangle_corners[]; };
layout(std430) writeonly buffer TriangleSurface { vec4 triangle_surface[]; };
uniform uint first;
uniform uint count;

vec3 vertex(uint index) { return texelFetch(positions, int(index)).xyz; }

void main() {
  const uint index = gl_GlobalInvocationID.x;
  if (index >= count) {
    return;
  }
  const uvec4 triangle = texelFetch(triangles, int(first + index));
  const TriangleSetup setup =
      set_up_triangle(vertex(triangle.x), vertex(triangle.y), vertex(triangle.z),
                      (triangle.w & kTwoSided) != 0u, projection);
  triangle_corners[3u * index] = setup.corner_a;
  triangle_corners[3u * index + 1u] = setup.corner_b;
  triangle_corners[3u * index + 2u] = setup.corner_c;
  triangle_surface[index] = setup.surface;
}
