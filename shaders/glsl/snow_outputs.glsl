// What a vertex of a receiver, tessellated or plain, hands on.
//
// CAPTURE: world positions to transform feedback. SHADOW, WIRE: the position on the picture alone.
#include "glsl/snow_points.glsl"

/// Plain and tessellated patches meet: both programs compute it to the same bits.
invariant gl_Position;
#ifdef CAPTURE
layout(xfb_buffer = 0, xfb_offset = 0, xfb_stride = 12) out vec3 captured;
#else
#ifndef SHADOW
#ifndef WIRE
#include "glsl/snow_base.glsl"
out vec3 world;
out vec3 snow_direction;
out vec3 bare_normal;
out vec3 rest_place;
out vec2 map_place;
/// From a patch's first corner to the second and third, on the surface (m), by how much the normal turns on the way,
/// and on the map (xy to the second, zw to the third).
flat out vec3 edge_1;
flat out vec3 edge_2;
flat out vec3 turn_1;
flat out vec3 turn_2;
flat out vec4 map_edges;
#endif
#endif
#endif

void hand_on(int index, vec3 at, SurfacePoint point) {
#ifdef CAPTURE
  captured = point.position;
#else
#ifndef SHADOW
#ifndef WIRE
  const SnowPatch of = patches[index];
  const vec2 uv[3] = vec2[3](of.uv_01.xy, of.uv_01.zw, of.uv_2.xy);
  world = point.position;
  snow_direction = point.direction;
  map_place = at.x * uv[0] + at.y * uv[1] + at.z * uv[2];
  bare_normal = vec3(0.0);
  rest_place = vec3(0.0);
  for (int k = 0; k < 3; ++k) {
    bare_normal += at[k] * corner_normals[3 * index + k].xyz;
    rest_place += at[k] * vertices[of.vertices[k]].rest.xyz;
  }
  const vec3 origin = vertices[of.vertices.x].position.xyz;
  edge_1 = vertices[of.vertices.y].position.xyz - origin;
  edge_2 = vertices[of.vertices.z].position.xyz - origin;
  const vec3 normal = corner_normals[3 * index].xyz;
  turn_1 = corner_normals[3 * index + 1].xyz - normal;
  turn_2 = corner_normals[3 * index + 2].xyz - normal;
  map_edges = vec4(uv[1] - uv[0], uv[2] - uv[0]);
#endif
#endif
#endif
  gl_Position = view.clip_from_world * vec4(point.position, 1.0);
}
