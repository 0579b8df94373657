// Selects the triangles of leaves that are drawn: those in the picture, and of distant leaves a part.
#include "glsl/tree_view.glsl"
#include "glsl/count_classes.glsl"
#include "glsl/leaf_growth.glsl"

uniform int first_vertex;

uint class_of(int index) {
  const LeafVertex at = leaf_vertices[first_vertex + 3 * index];
  const vec3 middle = posed_leaf(at, at.middle.xyz);
  const float growth = leaf_growth(at, middle);
  const int bone = 3 * floatBitsToInt(at.position.w);
  const float stretch = max(length(bone_rows[bone].xyz),
                            max(length(bone_rows[bone + 1].xyz), length(bone_rows[bone + 2].xyz)));
  const float radius = 1.7320508 * stretch * at.leaf.x * growth;
  return growth > 0.0 && !is_outside(middle, radius) ? kPlain : kDropped;
}
