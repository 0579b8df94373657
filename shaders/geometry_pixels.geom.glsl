#version 410 core
#extension GL_ARB_shading_language_420pack : require
// Places a pixel's snow on the texel under its centre and, where that one is small, on its neighbours.
#include "texel_spread.h"

layout(points) in;
// (2 * kSpreadReach + 1)^2
layout(points, max_vertices = 81) out;

flat in float volume[];
flat in int texel[];
flat out float deposit;
uniform float map_size;

void lay(ivec3 place, float thickness) {
  deposit = thickness;
  gl_Layer = place.z;
  gl_Position = vec4((vec2(place.xy) + 0.5) / map_size * 2.0 - 1.0, 0.0, 1.0);
  gl_PointSize = 1.0;
  EmitVertex();
  EndPrimitive();
}

void main() {
  if (texel[0] < 0 || volume[0] <= 0.0) {
    return;
  }
  const ivec3 place = place_of(texel[0]);
  const uint chart = texelFetch(owners, place, 0).y >> 8u;
  float area;
  const int reach = spread_reach(texel[0], place, chart, area);
  lay(place, volume[0] / area);
  for (int i = 0; reach > 0 && i < (2 * reach + 1) * (2 * reach + 1); ++i) {
    const ivec3 offset = ivec3(ivec2(i % (2 * reach + 1), i / (2 * reach + 1)) - reach, 0);
    if (offset.xy != ivec2(0) && sharing_texel(place + offset, chart) >= 0) {
      lay(place + offset, volume[0] / area);
    }
  }
}
