// Sum of the principal curvatures at every smooth point: twice the mean of its triangles, weighted by area. A triangle's
// mean curvature is the linear term of the volume between it and its copy displaced along the smooth normals, as in
// native/snow/seams/curvature.cpp.
layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
uniform samplerBuffer positions;
uniform usamplerBuffer triangles;
// See smooth_points.h.
uniform usamplerBuffer triangle_points;
uniform usamplerBuffer point_begin;
uniform usamplerBuffer point_corners;
uniform samplerBuffer point_normals;
uniform int count;
layout(std430) writeonly buffer Curvatures { float curvatures[]; };

vec3 normal_at(uint point) { return texelFetch(point_normals, int(point)).xyz; }

/// The term at the point of a triangle with these weights of its second and third corner.
float bend_at(vec3 u, vec3 v, vec3 a, vec3 b, vec3 c, vec2 at) {
  const vec3 mean = a * (1.0 - at.x - at.y) + b * at.x + c * at.y;
  const float size = length(mean);
  if (!(size > 1e-6)) {
    return 0.0;
  }
  const vec3 n = mean / size;
  const vec3 n_u = (b - a - n * dot(n, b - a)) / size;
  const vec3 n_v = (c - a - n * dot(n, c - a)) / size;
  return 0.5 * dot(cross(u, n_v) + cross(n_u, v), n);
}

void main() {
  const int point = item_index();
  if (point >= count) {
    return;
  }
  float area = 0.0;
  float sum = 0.0;
  const int end = int(texelFetch(point_begin, point + 1).x);
  for (int i = int(texelFetch(point_begin, point).x); i < end; ++i) {
    const int triangle = int(texelFetch(point_corners, i).x / 3u);
    const uvec4 corners = texelFetch(triangles, triangle);
    const uvec4 points = texelFetch(triangle_points, triangle);
    const vec3 first = texelFetch(positions, int(corners.x)).xyz;
    const vec3 u = texelFetch(positions, int(corners.y)).xyz - first;
    const vec3 v = texelFetch(positions, int(corners.z)).xyz - first;
    const vec3 a = normal_at(points.x);
    const vec3 b = normal_at(points.y);
    const vec3 c = normal_at(points.z);
    area += length(cross(u, v));
    sum += (bend_at(u, v, a, b, c, vec2(1.0, 1.0) / 6.0) + bend_at(u, v, a, b, c, vec2(4.0, 1.0) / 6.0) +
            bend_at(u, v, a, b, c, vec2(1.0, 4.0) / 6.0)) / 3.0;
  }
  curvatures[point] = area > 0.0 ? 2.0 * sum / area : 0.0;
}
