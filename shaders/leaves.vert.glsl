// Leaves as cards: triangles whose vertices follow one bone each.
//
// SHADOW: shadow map, depth only.
#include "glsl/tree_view.glsl"
#include "glsl/leaf_growth.glsl"

layout(std430) readonly buffer PlainPatches { uint plain_patches[]; };
uniform int first_vertex;
out vec2 image_uv;
#ifndef SHADOW
out vec3 world;
out vec3 card_normal;
#endif

void main() {
  const uint triangle = plain_patches[gl_VertexID / 3];
  const LeafVertex at = leaf_vertices[first_vertex + 3 * int(triangle) + gl_VertexID % 3];
  vec3 position = posed_leaf(at, at.position.xyz);
  const vec3 middle = posed_leaf(at, at.middle.xyz);
  const float growth = leaf_growth(at, middle);
  if (growth != 1.0) {
    position = middle + growth * (position - middle);
  }
  image_uv = vec2(at.normal.w, at.middle.w);
#ifndef SHADOW
  const int bone = 3 * floatBitsToInt(at.position.w);
  const vec3 n = at.normal.xyz;
  world = position;
  card_normal =
      vec3(dot(bone_rows[bone].xyz, n), dot(bone_rows[bone + 1].xyz, n), dot(bone_rows[bone + 2].xyz, n));
#endif
  gl_Position = view.clip_from_world * vec4(position, 1.0);
}
