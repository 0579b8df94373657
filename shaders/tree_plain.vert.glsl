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
#ifdef IMAGE
layout(std430) readonly buffer BarkPlaces { BarkPlace bark_places[]; };
/// Coordinates of the bark's image, and its layer.
out vec3 image_place;
#endif
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

vec2 corner_uv(vec4 uv_01, vec4 uv_23, int corner) {
  const vec4 uv = corner < 2 ? uv_01 : uv_23;
  return (corner & 1) == 0 ? uv.xy : uv.zw;
}

void main() {
  const uint index = plain_patches[gl_VertexID / 6];
  const TreePatch of = patches[index];
  const int corner = kCorners[gl_VertexID % 6];
  const PosedVertex at = posed[of.vertices[corner]];
#ifdef CAPTURE
  captured = at.position.xyz;
#else
#ifndef SHADOW
  world = at.position.xyz;
  smooth_normal = at.normal.xyz;
  bark = vec4(corner_uv(of.bark_uv_01, of.bark_uv_23, corner), at.normal.w, at.position.w);
#ifdef IMAGE
  const BarkPlace place = bark_places[index];
  image_place = vec3(corner_uv(place.uv_01, place.uv_23, corner), place.layer.x);
#endif
#ifdef SNOW
#ifndef WIRE
  snow_place = corner_uv(of.snow_uv_01, of.snow_uv_23, corner);
  rest_place = vertices[of.vertices[corner]].position.xyz;
#endif
#endif
#endif
#endif
  gl_Position = view.clip_from_world * vec4(at.position.xyz, 1.0);
}
