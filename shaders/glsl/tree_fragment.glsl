// A pixel of the tree, plain or tessellated alike.
//
// SHADOW: depth alone. WIRE: the lines of a wireframe, or the paper that hides those behind.
#ifndef SHADOW
layout(location = 0) out vec4 color;
#ifdef WIRE
uniform vec4 wire_color;
#else
#include "glsl/bark_shading.glsl"
in vec3 world;
in vec3 smooth_normal;
in vec4 bark;
#endif
#endif

void main() {
#ifndef SHADOW
#ifdef WIRE
  color = wire_color;
#else
  color = shaded_bark(world, smooth_normal, bark);
#endif
#endif
}
