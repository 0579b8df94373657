// A mesh without tessellation: the ground, and the tree at a fixed level for comparison.
//
// SHADOW: the sun's picture, of depth alone.
#include "glsl/tree_view.glsl"

/// Position and normal of each vertex, and three vertices a triangle.
layout(std430) readonly buffer MeshVertices { vec4 mesh_vertices[]; };
layout(std430) readonly buffer MeshCorners { uint mesh_corners[]; };
#ifndef SHADOW
out vec3 world;
out vec3 smooth_normal;
#endif

void main() {
  const int at = 2 * int(mesh_corners[gl_VertexID]);
  const vec3 position = mesh_vertices[at].xyz;
#ifndef SHADOW
  world = position;
  smooth_normal = mesh_vertices[at + 1].xyz;
#endif
  gl_Position = view.clip_from_world * vec4(position, 1.0);
}
