// The triangle of a patch that needs no tessellation.
#include "glsl/snow_outputs.glsl"

layout(std430) readonly buffer PlainPatches { uint plain_patches[]; };

void main() {
  const int index = int(plain_patches[gl_VertexID / 3]);
  const int corner = gl_VertexID % 3;
  vec3 at = vec3(0.0);
  at[corner] = 1.0;
  hand_on(index, at, vertex_surface(patches[index].vertices[corner]));
}
