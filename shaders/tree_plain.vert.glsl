// Draws a patch without tessellation as two triangles of three vertices each.
#include "glsl/tree_view.glsl"
#include "glsl/tree_outputs.glsl"

#include "glsl/tree_base.glsl"
layout(std430) readonly buffer TreePatches { TreePatch patches[]; };
layout(std430) readonly buffer PlainPatches { ivec2 plain_patches[]; };
layout(std430) readonly buffer PatchGrowths { PatchGrowth growths[]; };
layout(std430) readonly buffer TreeSections { TreeSection sections[]; };
#include "glsl/limb_reach.glsl"
#include "glsl/inset_normal.glsl"
#ifdef SNOW
#ifndef CAPTURE
#ifndef SHADOW
#ifndef WIRE
#include "glsl/tree_snow.glsl"
#endif
#endif
#endif
#endif

const int kCorners[6] = int[6](0, 1, 2, 0, 2, 3);

vec2 corner_uv(vec4 uv_01, vec4 uv_23, int corner) {
  const vec4 uv = corner < 2 ? uv_01 : uv_23;
  return (corner & 1) == 0 ? uv.xy : uv.zw;
}

/// Position of a vertex on a patch that grows because others are dropped.
vec3 grown(PosedVertex at, TreeVertex vertex, PatchGrowth growth) {
  if (growth.middle.w == 1.0 && growth.along.x == 1.0) {
    return at.position.xyz;
  }
  const vec3 middle = limb_middle(at, vertex);
  return mix(growth.middle.xyz, middle, growth.along.x) + growth.middle.w * (at.position.xyz - middle);
}

void main() {
  const ivec2 drawn = plain_patches[gl_VertexID / 6];
  tree = instances[drawn.x];
  const TreePatch of = patches[tree.base.z + drawn.y];
  const int corner = kCorners[gl_VertexID % 6];
  const PosedVertex at = posed_of(of.vertices[corner]);
  const TreeVertex vertex = vertex_of(of.vertices[corner]);
  const vec3 position = grown(at, vertex, growths[tree.own.z + drawn.y]);
#ifdef CAPTURE
  captured = position;
#else
#ifndef SHADOW
  world = position;
  smooth_normal = at.normal.xyz;
  if (corner > 1 && is_inset(of)) {
    smooth_normal = normalize(smooth_normal + turn_at(of, vertex, at));
  }
  bark = vec4(corner_uv(of.bark_uv_01, of.bark_uv_23, corner), at.normal.w, at.position.w);
#ifdef IMAGE
  const BarkUv uv = bark_uvs[tree.lists.y + drawn.y];
  image_uv = vec3(corner_uv(uv.uv_01, uv.uv_23, corner), uv.layer.x);
#endif
#ifndef WIRE
  drawn_tree = drawn.x;
#ifdef SNOW
  snow_map = tree.map;
  snow_depths = tree.snow;
  snow_style = tree.style;
  snow_uv = corner_uv(of.snow_uv_01, of.snow_uv_23, corner);
  rest_position = vertex.position.xyz;
  snow_noises = has_snow() ? limb_noise(rest_position) : vec4(0.0);
#endif
#endif
#endif
#endif
  gl_Position = view.clip_from_world * vec4(position, 1.0);
}
