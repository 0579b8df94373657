// How distant leaves are drawn: some are dropped, and the others grow (lib/thin_limbs.h). Needs tree_view.glsl.
#include "lib/leaf_vertex.h"
#include "lib/thin_limbs.h"
#include "glsl/tree_instance.glsl"

layout(std430) readonly buffer LeafVertices { LeafVertex leaf_vertices[]; };
layout(std430) readonly buffer BoneRows { vec4 bone_rows[]; };

/// Rows of the matrix from a leaf's rest pose to the world.
struct LeafRows {
  vec4 x;
  vec4 y;
  vec4 z;
};

LeafRows leaf_rows(LeafVertex at) {
  const int bone = 3 * (tree.own.w + floatBitsToInt(at.position.w));
  LeafRows rows = LeafRows(bone_rows[bone], bone_rows[bone + 1], bone_rows[bone + 2]);
  rows_to_world(rows.x, rows.y, rows.z);
  return rows;
}

vec3 posed_leaf(LeafRows rows, vec3 rest) {
  const vec4 p = vec4(rest, 1.0);
  return vec3(dot(rows.x, p), dot(rows.y, p), dot(rows.z, p));
}

/// Factor of a leaf's length and width; 0: dropped. `middle`: posed.
float leaf_growth(LeafVertex at, vec3 middle) {
  const float pixels = 2.0 * at.leaf.x * view.eye.w / max(distance(view.eye.xyz, middle), 1e-6);
  const float share = drawn_share(pixels, kMinLeaf * view.tessellation.w);
  return share < 1.0 ? sqrt(area_factor(share * share, at.leaf.y)) : 1.0;
}
