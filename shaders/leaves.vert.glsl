// Leaves as cards: triangles whose vertices follow one bone each.
//
// SHADOW: shadow map, depth only.
#include "glsl/tree_view.glsl"
#include "glsl/leaf_growth.glsl"

layout(std430) readonly buffer PlainPatches { ivec2 plain_patches[]; };
out vec2 image_uv;
#ifndef SHADOW
out vec3 world;
out vec3 card_normal;
#endif

void main() {
  const ivec2 drawn = plain_patches[gl_VertexID / 3];
  tree = instances[drawn.x];
  const LeafVertex at = leaf_vertices[3 * drawn.y + gl_VertexID % 3];
  const LeafRows rows = leaf_rows(at);
  vec3 position = posed_leaf(rows, at.position.xyz);
  const vec3 middle = posed_leaf(rows, at.middle.xyz);
  const float growth = leaf_growth(at, middle);
  if (growth != 1.0) {
    position = middle + growth * (position - middle);
  }
  image_uv = vec2(at.normal.w, at.middle.w);
#ifndef SHADOW
  const vec3 n = at.normal.xyz;
  world = position;
  card_normal = vec3(dot(rows.x.xyz, n), dot(rows.y.xyz, n), dot(rows.z.xyz, n));
#endif
  gl_Position = view.clip_from_world * vec4(position, 1.0);
}
