// The middle line of a limb beside its vertices, and its width in the picture. Needs tree_base.glsl and tree_view.glsl.

/// The parameters of eq. 3.4.1 for the instance, with its number of branch levels.
vec4 thesis_of_tree() {
  const float area = view.thesis.y > 0.0 ? view.thesis.y : tree.bark_dark.w;
  return vec4(view.thesis.x, area, tree.bark_light.w, view.thesis.w);
}

/// Point on the limb's middle line beside a vertex, posed.
vec3 limb_middle(PosedVertex at, TreeVertex vertex) {
  const vec4 p = vec4(vertex.position.xyz, 1.0);
  const vec3 bare = vec3(dot(at.row_x, p), dot(at.row_y, p), dot(at.row_z, p));
  return bare - at.normal.xyz * (at.normal.w / 6.2831853);
}

/// Pixels that a length in metres covers at a distance, seen perpendicular.
float pixels_of(float metres, float away) {
  return metres * view.eye.w / max(away, 1e-6);
}
