// World position and covered area of texels, from the current vertices.
#include "snow_shared.h"

layout(local_size_x = 64) in;
layout(std430) readonly buffer Positions { float positions[]; };
layout(std430) readonly buffer Triangles { SceneTriangle triangles[]; };
layout(std430) readonly buffer TriangleSurface { vec4 triangle_surface[]; };
layout(std430) readonly buffer Texels { Texel texels[]; };
layout(std430) readonly buffer FragmentBegin { uint fragment_begin[]; };
layout(std430) readonly buffer Fragments { Fragment fragments[]; };
/// xyz: position in metres, w: covered area in m2.
layout(std430) writeonly buffer TexelSurface { vec4 texel_surface[]; };
uniform uint first;

vec3 vertex(uint index) {
  return vec3(positions[3u * index], positions[3u * index + 1u], positions[3u * index + 2u]);
}

void main() {
  const uint index = first + gl_GlobalInvocationID.x;
  const Texel texel = texels[index];
  if (texel.place == kNowhere) {
    return;
  }
  const SceneTriangle triangle = triangles[texel.triangle];
  const vec3 a = vertex(triangle.a);
  const vec3 position = a + texel.weight_b * (vertex(triangle.b) - a) +
                        texel.weight_c * (vertex(triangle.c) - a);
  float area = 0.0;
  for (uint i = fragment_begin[index]; i < fragment_begin[index + 1u]; ++i) {
    area += fragments[i].share * triangle_surface[fragments[i].triangle].w;
  }
  texel_surface[index] = vec4(position, area);
}
