// Shading normals of insets: beside a child's hole the parent stays as round as elsewhere, but the normals of the rim's
// vertices also belong to the child. Needs tree_base.glsl and TreeSections.
#include "lib/limb_section.h"

/// True if a patch's corners 2 and 3 lie on a rim.
bool is_inset(TreePatch of) {
  return of.limb.w >= kRoundInset;
}

/// The change of the posed normal at a corner of an inset.
vec3 turn_at(TreePatch of, TreeVertex vertex, PosedVertex at) {
  const vec3 turn = limb_normal(sections[tree.base.w + of.limb.x], vertex.position.xyz) - vertex.normal.xyz;
  return vec3(dot(at.row_x.xyz, turn), dot(at.row_y.xyz, turn), dot(at.row_z.xyz, turn));
}

/// The normal at a point of a patch, from that of the vertices.
vec3 shading_normal(TreePatch of, vec2 at, vec3 normal) {
  if (!is_inset(of) || at.y <= 0.0) {
    return normal;
  }
  const ivec4 v = of.vertices;
  return normalize(normal + at.y * mix(turn_at(of, vertex_of(v.w), posed_of(v.w)),
                                       turn_at(of, vertex_of(v.z), posed_of(v.z)), at.x));
}
