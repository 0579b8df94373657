// A pixel of a mesh in one colour.
//
// SHADOW: depth alone. WIRE: one colour, unlit.
#ifndef SHADOW
layout(location = 0) out vec4 color;
#ifdef WIRE
uniform vec4 wire_color;
#else
#include "glsl/lighting.glsl"
/// Linear.
uniform vec4 mesh_color;
in vec3 world;
in vec3 smooth_normal;
#endif
#endif

void main() {
#ifndef SHADOW
#ifdef WIRE
  color = wire_color;
#else
  const vec3 normal = normalize(smooth_normal);
  color = encoded(lit(mesh_color.rgb, world, normal, normal, 0.0));
#endif
#endif
}
