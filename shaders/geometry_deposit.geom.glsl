#version 410 core
#extension GL_ARB_shading_language_420pack : require
// Places a deposit on its texel of the layered map.
layout(points) in;
layout(points, max_vertices = 1) out;

flat in float thickness[];
flat in ivec3 map_place[];
flat out float deposit;
uniform float map_size;

void main() {
  if (map_place[0].z >= 0) {
    deposit = thickness[0];
    gl_Layer = map_place[0].z;
    gl_Position = vec4((vec2(map_place[0].xy) + 0.5) / map_size * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
    EmitVertex();
    EndPrimitive();
  }
}
