// Two triangles of a patch that needs no tessellation, six vertices each.
//
// CAPTURE: hands world positions to transform feedback. SHADOW: the sun's picture, of depth alone.
#include "glsl/tree_view.glsl"

layout(std430) readonly buffer PosedVertices { PosedVertex posed[]; };
layout(std430) readonly buffer TreePatches { TreePatch patches[]; };
layout(std430) readonly buffer PlainPatches { uint plain_patches[]; };
#ifdef CAPTURE
layout(xfb_buffer = 0, xfb_offset = 0, xfb_stride = 12) out vec3 captured;
#else
#ifndef SHADOW
out vec3 world;
out vec3 smooth_normal;
out vec4 bark;
#endif
#endif

const int kCorners[6] = int[6](0, 1, 2, 0, 2, 3);

void main() {
  const TreePatch of = patches[plain_patches[gl_VertexID / 6]];
  const int corner = kCorners[gl_VertexID % 6];
  const PosedVertex at = posed[of.vertices[corner]];
#ifdef CAPTURE
  captured = at.position.xyz;
#else
#ifndef SHADOW
  world = at.position.xyz;
  smooth_normal = at.normal.xyz;
  const vec4 uv = corner < 2 ? of.bark_uv_01 : of.bark_uv_23;
  bark = vec4((corner & 1) == 0 ? uv.xy : uv.zw, at.normal.w, at.position.w);
#endif
#endif
  gl_Position = view.clip_from_world * vec4(at.position.xyz, 1.0);
}
