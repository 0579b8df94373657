// Selects the triangles of leaves that are drawn: those in the picture, and of distant leaves a part.
#include "glsl/tree_view.glsl"
#include "glsl/count_classes.glsl"
#include "glsl/leaf_growth.glsl"

uint class_of(WorkRange range, int triangle) {
  tree = instances[range.instance];
  const LeafVertex at = leaf_vertices[3 * triangle];
  const LeafRows rows = leaf_rows(at);
  const vec3 middle = posed_leaf(rows, at.middle.xyz);
  const float growth = leaf_growth(at, middle);
  const float stretch = max(length(rows.x.xyz), max(length(rows.y.xyz), length(rows.z.xyz)));
  const float radius = 1.7320508 * stretch * at.leaf.x * growth;
  return growth > 0.0 && !is_outside(middle, radius) ? kPlain : kDropped;
}
