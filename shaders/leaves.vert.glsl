// Leaves as cards: triangles whose vertices follow one bone each.
//
// SHADOW: shadow map, depth only.
#include "glsl/tree_view.glsl"
#include "lib/leaf_vertex.h"

layout(std430) readonly buffer LeafVertices { LeafVertex leaf_vertices[]; };
layout(std430) readonly buffer BoneRows { vec4 bone_rows[]; };
uniform int first_vertex;
out vec2 image_uv;
#ifndef SHADOW
out vec3 world;
out vec3 card_normal;
#endif

void main() {
  const LeafVertex at = leaf_vertices[first_vertex + gl_VertexID];
  const int bone = 3 * floatBitsToInt(at.position.w);
  const vec4 p = vec4(at.position.xyz, 1.0);
  const vec3 position =
      vec3(dot(bone_rows[bone], p), dot(bone_rows[bone + 1], p), dot(bone_rows[bone + 2], p));
  image_uv = vec2(at.normal.w, at.uv_end.x);
#ifndef SHADOW
  const vec3 n = at.normal.xyz;
  world = position;
  card_normal =
      vec3(dot(bone_rows[bone].xyz, n), dot(bone_rows[bone + 1].xyz, n), dot(bone_rows[bone + 2].xyz, n));
#endif
  gl_Position = view.clip_from_world * vec4(position, 1.0);
}
