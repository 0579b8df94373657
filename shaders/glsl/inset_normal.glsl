// Shading normals of insets: beside a child's hole the parent stays as round as elsewhere, but the normals of the rim's
// vertices also belong to the child. Needs tree_base.glsl and TreeSections.
#include "lib/limb_section.h"

/// The change of the posed normal at a patch's corner.
vec3 turn_at(TreePatch of, int corner) {
  const int index = of.vertices[corner];
  const TreeVertex vertex = vertex_of(index);
  const PosedVertex at = posed_of(index);
  const vec3 turn = limb_normal(sections[tree.base.w + of.place.x], vertex.position.xyz) - vertex.normal.xyz;
  return vec3(dot(at.row_x.xyz, turn), dot(at.row_y.xyz, turn), dot(at.row_z.xyz, turn));
}

/// The normal at a point of a patch, from that of the vertices.
vec3 shading_normal(TreePatch of, vec2 at, vec3 normal) {
  if (of.place.w < kRoundInset || at.y <= 0.0) {
    return normal;
  }
  return normalize(normal + at.y * mix(turn_at(of, 3), turn_at(of, 2), at.x));
}
