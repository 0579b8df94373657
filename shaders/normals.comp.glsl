// The snow surface's normal in tangent space, from the heights in the line arrays: central differences
// across seams, made slopes along tangent and bitangent by the layout's first fundamental form
// (native/snow/output/normals.h).
layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(std430) readonly buffer TexelTriangle { int texel_triangle[]; };
/// Three floats a triangle: dP/du . dP/du, dP/du . dP/dv, dP/dv . dP/dv, in m2 a texel.
layout(std430) readonly buffer Metrics { float metrics[]; };
layout(std430) readonly buffer PlaceU { int place_u[]; };
layout(std430) readonly buffer PlaceV { int place_v[]; };
layout(std430) readonly buffer LineU { float line_u[]; };
layout(std430) readonly buffer LineV { float line_v[]; };
layout(std430) writeonly buffer Normals { vec4 normals[]; };
uniform int count;
/// See kNothing in native/snow/seams/seam_table.h.
const float kSomething = -1e29;

float difference(float before, float here, float after) {
  const float span = (before > kSomething ? 1.0 : 0.0) + (after > kSomething ? 1.0 : 0.0);
  const float low = before > kSomething ? before : here;
  const float high = after > kSomething ? after : here;
  return span == 0.0 ? 0.0 : (high - low) / span;
}

void main() {
  const int index = item_index();
  if (index >= count) {
    return;
  }
  const int u = place_u[index];
  const int v = place_v[index];
  const float rise_u = difference(line_u[u - 1], line_u[u], line_u[u + 1]);
  const float rise_v = difference(line_v[v - 1], line_v[v], line_v[v + 1]);
  const int triangle = 3 * texel_triangle[index];
  const float tangent = sqrt(metrics[triangle]);
  vec3 normal = vec3(0.0, 0.0, 1.0);
  if (tangent > 0.0) {
    const float sheared = metrics[triangle + 1] / tangent;
    const float across_squared = metrics[triangle + 2] - sheared * sheared;
    if (across_squared > 0.0) {
      const float slope_t = rise_u / tangent;
      const float slope_b = (rise_v - slope_t * sheared) / sqrt(across_squared);
      normal = normalize(vec3(-slope_t, -slope_b, 1.0));
    }
  }
  normals[index] = vec4(normal, 0.0);
}
