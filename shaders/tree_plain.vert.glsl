// Two triangles of a patch that needs no tessellation, six vertices each.
//
// CAPTURE: hands world positions to transform feedback. SHADOW: the sun's picture, of depth alone.
#include "glsl/tree_view.glsl"

/// Plain and tessellated patches meet: both programs compute it to the same bits.
invariant gl_Position;
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
#ifdef SNOW
#ifndef WIRE
layout(std430) readonly buffer TreeVertices { TreeVertex vertices[]; };
/// Where the snow is on its map, and the bark in the rest pose.
out vec2 snow_place;
out vec3 rest_place;
#endif
#endif
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
#ifdef SNOW
#ifndef WIRE
  const vec4 on_map = corner < 2 ? of.snow_uv_01 : of.snow_uv_23;
  snow_place = (corner & 1) == 0 ? on_map.xy : on_map.zw;
  rest_place = vertices[of.vertices[corner]].position.xyz;
#endif
#endif
#endif
#endif
  gl_Position = view.clip_from_world * vec4(at.position.xyz, 1.0);
}
