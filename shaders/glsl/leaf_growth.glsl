// How distant leaves are drawn: some are dropped, and the others grow (lib/thin_limbs.h). Needs tree_view.glsl.
#include "lib/leaf_vertex.h"
#include "lib/thin_limbs.h"

layout(std430) readonly buffer LeafVertices { LeafVertex leaf_vertices[]; };
layout(std430) readonly buffer BoneRows { vec4 bone_rows[]; };

vec3 posed_leaf(LeafVertex at, vec3 rest) {
  const int bone = 3 * floatBitsToInt(at.position.w);
  const vec4 p = vec4(rest, 1.0);
  return vec3(dot(bone_rows[bone], p), dot(bone_rows[bone + 1], p), dot(bone_rows[bone + 2], p));
}

/// Factor of a leaf's length and width; 0: dropped. `middle`: posed.
float leaf_growth(LeafVertex at, vec3 middle) {
  const float pixels = 2.0 * at.leaf.x * view.eye.w / max(distance(view.eye.xyz, middle), 1e-6);
  const float share = drawn_share(pixels, kLeastLeaf * view.tessellation.w);
  return share < 1.0 ? sqrt(area_factor(share * share, at.leaf.y)) : 1.0;
}
