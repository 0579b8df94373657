// Lays snow on the vertices of a receiver's base: one height and one direction each, the means over the places on the
// map and the normals that meet there.
#include "glsl/snow_map.glsl"
#include "glsl/snow_rims.glsl"
#include "lib/snow_patch.h"

layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(std430) readonly buffer SnowVertices { SnowVertex vertices[]; };
layout(std430) readonly buffer VertexCorners { int vertex_corners[]; };
layout(std430) readonly buffer SnowEdges { SnowEdge edges[]; };
layout(std430) readonly buffer SnowPatches { SnowPatch patches[]; };
layout(std430) readonly buffer CornerNormals { vec4 corner_normals[]; };
layout(std430) writeonly buffer SnowPoints { SnowPoint points[]; };
uniform int count;

/// Mean of the normals of a hard edge's two faces at a share t.
vec3 rim_direction(SnowEdge edge, float t) {
  const vec3 one = normalize(mix(corner_normals[edge.corners.x].xyz, corner_normals[edge.corners.y].xyz, t));
  const vec3 other = normalize(mix(corner_normals[edge.corners.z].xyz, corner_normals[edge.corners.w].xyz, t));
  return toward(one, other, 0.5);
}

void main() {
  const int index = item_index();
  if (index >= count) {
    return;
  }
  const SnowVertex vertex = vertices[index];
  float height = 0.0;
  vec3 sum = vec3(0.0);
  for (int i = vertex.corners.x; i < vertex.corners.y; ++i) {
    const int corner = vertex_corners[i];
    const SnowPatch of = patches[corner / 3];
    const int k = corner % 3;
    height += height_at(k == 0 ? of.uv_01.xy : k == 1 ? of.uv_01.zw : of.uv_2.xy);
    sum += corner_normals[corner].xyz;
  }
  height /= float(max(vertex.corners.y - vertex.corners.x, 1));
  const vec3 mean = toward(corner_normals[vertex_corners[vertex.corners.x]].xyz, sum, 1.0);
  // On a hard edge the mean is where its rim leans to; elsewhere that is told by the nearest one.
  vec4 rim = vec4(mean, vertex.rims.x);
  if (vertex.corners.z >= 0 && vertex.rims.x > 0.0) {
    rim.xyz = rim_direction(edges[vertex.corners.z], vertex.rims.y);
  }
  const float texel = vertex.position.w;
  const vec3 direction = leaning(mean, rim, height, texel);
  height = shouldered(height, vertex.rims.z, texel);
  const vec3 at = vertex.position.xyz + bent_under(vertex.bend.xyz, height) + direction * height;
  points[index] = SnowPoint(vec4(at, height), vec4(direction, vertex.rims.z), rim);
}
