// The middle line of a limb beside its vertices, and its width in the picture. Needs PosedVertices, TreeVertices and
// tree_view.glsl.

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
