// The surface of a receiver's snow: vertices from their records, points of edges from the edge's record alone (both
// faces of an edge find the same bits, also where it is a seam of the layout), points within a patch from the patch.
#include "glsl/snow_base.glsl"
#include "glsl/snow_map.glsl"
#include "glsl/snow_points.glsl"
#include "glsl/snow_rims.glsl"

layout(std430) readonly buffer SnowEdges { SnowEdge edges[]; };
layout(std430) readonly buffer EdgeBends { vec4 edge_bends[]; };

/// Mean of the normals of an edge's two faces at a share t.
vec3 edge_normal(SnowEdge edge, float t) {
  const vec3 one = mix(vec3(corner_normals[edge.corners.x]), vec3(corner_normals[edge.corners.y]), t);
  const vec3 other = mix(vec3(corner_normals[edge.corners.z]), vec3(corner_normals[edge.corners.w]), t);
  return toward(one / max(length(one), 1e-12), other / max(length(other), 1e-12), 0.5);
}

/// The point at a share t, within 0 and 1, from an edge's first to its last vertex.
SurfacePoint edge_surface(int index, float t) {
  const SnowEdge edge = edges[index];
  const vec4 bare = mix(vertices[edge.ends.x].position, vertices[edge.ends.y].position, t);
  const SnowPoint a = points[edge.ends.x];
  const SnowPoint b = points[edge.ends.y];
  const float mean =
      0.5 * (height_at(mix(edge.uv.xy, edge.uv.zw, t)) + height_at(mix(edge.other_uv.xy, edge.other_uv.zw, t)));
  const float end = edge.ends.z != 0 ? 0.0 : mix(a.direction.w, b.direction.w, t);
  const float height = shouldered(mean, end, bare.w);
  const vec3 direction = leaning(edge_normal(edge, t), mix(a.rim, b.rim, t), mean, bare.w);
  const vec3 bend = mix(vec3(vertices[edge.ends.x].bend), vec3(vertices[edge.ends.y].bend), t) +
                    t * (1.0 - t) * vec3(edge_bends[index]);
  precise vec3 position = bare.xyz + bent_under(bend, height) + direction * height;
  return SurfacePoint(position, direction);
}

/// A point within a patch, at weights of its corners.
SurfacePoint inner_surface(int index, vec3 at) {
  const SnowPatch of = patches[index];
  vec4 bare = vec4(0.0);
  vec3 normal = vec3(0.0);
  vec4 rim = vec4(0.0);
  vec3 bend = vec3(0.0);
  float end = 0.0;
  for (int k = 0; k < 3; ++k) {
    const SnowPoint corner = points[of.vertices[k]];
    bare += at[k] * vertices[of.vertices[k]].position;
    normal += at[k] * vec3(corner_normals[3 * index + k]);
    rim += at[k] * corner.rim;
    end += at[k] * corner.direction.w;
    bend += at[k] * vec3(vertices[of.vertices[k]].bend) +
            at[k] * at[(k + 1) % 3] * vec3(edge_bends[of.edges[k] >> 1]);
  }
  const float whole = height_at(at.x * of.uv_01.xy + at.y * of.uv_01.zw + at.z * of.uv_2.xy);
  const float height = shouldered(whole, end, bare.w);
  const vec3 direction = leaning(normal / max(length(normal), 1e-12), rim, whole, bare.w);
  return SurfacePoint(bare.xyz + bent_under(bend, height) + direction * height, direction);
}

/// The point of a patch at the tessellator's weights of its corners.
SurfacePoint patch_surface(int index, vec3 at) {
  const SnowPatch of = patches[index];
  for (int k = 0; k < 3; ++k) {
    if (at[(k + 1) % 3] <= 0.0 && at[(k + 2) % 3] <= 0.0) {
      return vertex_surface(of.vertices[k]);
    }
  }
  for (int k = 0; k < 3; ++k) {
    if (at[(k + 2) % 3] <= 0.0) {
      const float along = at[(k + 1) % 3];
      return edge_surface(of.edges[k] >> 1, (of.edges[k] & 1) != 0 ? 1.0 - along : along);
    }
  }
  return inner_surface(index, at);
}
