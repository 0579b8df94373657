// A mesh without tessellation, in instances.
//
// SHADOW: shadow map, depth only. SNOW: passes coordinates on the snow map. IS_SNOW: passes the position in the mesh's
// own space, to which the grains of snow are fixed.
#include "glsl/tree_view.glsl"
#include "lib/mesh_corner.h"

layout(std430) readonly buffer MeshCorners { MeshCorner mesh_corners[]; };
/// Three matrix rows per instance.
layout(std430) readonly buffer MeshInstances { vec4 instance_rows[]; };
out vec2 image_uv;
#ifdef SNOW
layout(std430) readonly buffer SnowCorners { vec2 snow_corners[]; };
out vec2 snow_uv;
#endif
#ifndef SHADOW
out vec3 world;
out vec3 smooth_normal;
#ifdef IS_SNOW
out vec3 own_position;
#endif
#endif

void main() {
  const MeshCorner at = mesh_corners[gl_VertexID];
  const int row = 3 * gl_InstanceID;
  const vec3 x = instance_rows[row].xyz;
  const vec3 y = instance_rows[row + 1].xyz;
  const vec3 z = instance_rows[row + 2].xyz;
  const vec3 p = at.position.xyz;
  const vec3 position =
      vec3(dot(x, p), dot(y, p), dot(z, p)) + vec3(instance_rows[row].w, instance_rows[row + 1].w, instance_rows[row + 2].w);
  image_uv = vec2(at.position.w, at.normal.w);
#ifdef SNOW
  snow_uv = snow_corners[gl_VertexID];
#endif
#ifndef SHADOW
  world = position;
#ifdef IS_SNOW
  own_position = p;
#endif
  // Transform normals by the cofactor matrix, so that they stay perpendicular at any scale of the instance. It flips the
  // normals of mirrored instances.
  const vec3 n = at.normal.xyz * (dot(cross(x, y), z) < 0.0 ? -1.0 : 1.0);
  smooth_normal = vec3(dot(cross(y, z), n), dot(cross(z, x), n), dot(cross(x, y), n));
#endif
  gl_Position = view.clip_from_world * vec4(position, 1.0);
}
