// World position and covered area of texels, from the current vertices.
#include "texel_group.h"

layout(local_size_x = 64) in;
uniform samplerBuffer positions;
uniform usamplerBuffer triangles;
uniform samplerBuffer triangle_surface;
uniform usamplerBuffer texels;
uniform usamplerBuffer fragment_begin;
/// Triangle, and bits of the share.
uniform usamplerBuffer fragments;
/// xyz: position in metres, w: covered area in m2.
layout(std430) writeonly buffer TexelSurface { vec4 texel_surface[]; };
/// Upward part of the normal, 1 on level ground, for the capacity. A texel that goes round a twig holds
/// snow by those of its parts that face up; one without any is past vertical by the mean of its parts.
layout(std430) writeonly buffer TexelUp { float texel_up[]; };

vec3 vertex(uint index) { return texelFetch(positions, int(index)).xyz; }

void main() {
  const int index = listed_texel();
  const uvec4 texel = texelFetch(texels, index);
  if (texel.y == kNowhere) {
    return;
  }
  const uvec4 triangle = texelFetch(triangles, int(texel.x));
  const vec3 a = vertex(triangle.x);
  const vec3 position = a + uintBitsToFloat(texel.z) * (vertex(triangle.y) - a) +
                        uintBitsToFloat(texel.w) * (vertex(triangle.z) - a);
  float area = 0.0;
  float up = 0.0;
  float upper = 0.0;
  int i = int(texelFetch(fragment_begin, index).x);
  const int end = int(texelFetch(fragment_begin, index + 1).x);
  // The end is asked for at the end: llvmpipe runs a loop's body once more for a test at its head.
  do {
    const uvec2 fragment = texelFetch(fragments, i).xy;
    const vec4 surface = texelFetch(triangle_surface, int(fragment.x));
    const float own = i < end ? uintBitsToFloat(fragment.y) * surface.w : 0.0;
    area += own;
    up += own * surface.z;
    upper += own * max(surface.z, 0.0);
  } while (++i < end);
  texel_surface[index] = vec4(position, area);
  texel_up[index] = area > 0.0 ? (upper > 0.0 ? upper : up) / area : 0.0;
}
