// Poses the vertices of the base and adds bark.
//
// SNOW: also adds snow to trees that have some, from the mean of the map's heights at the vertex's coordinates.
#include "glsl/bark.glsl"
#include "glsl/tree_view.glsl"
#include "glsl/work_range.glsl"
#include "glsl/tree_instance.glsl"
#include "glsl/limb_growth.glsl"

layout(std430) readonly buffer TreeVertices { TreeVertex vertices[]; };
layout(std430) writeonly buffer PosedVertices { PosedVertex posed[]; };
/// Three rows of a matrix per bone, from the rest pose to the pose.
layout(std430) readonly buffer BoneRows { vec4 bone_rows[]; };
#ifdef SNOW
#include "glsl/tree_snow.glsl"
layout(std430) readonly buffer VertexSnow { vec2 vertex_snow[]; };

float snow_on(TreeVertex vertex) {
  const int begin = floatBitsToInt(vertex.bark_uv.z);
  const int end = floatBitsToInt(vertex.bark_uv.w);
  float sum = 0.0;
  for (int i = begin; i < end; ++i) {
    sum += height_between(vertex_snow[tree.lists.x + i]);
  }
  return sum / float(max(end - begin, 1));
}
#endif

void main() {
  const WorkRange range = work_range();
  const int index = work_slot() - range.first_slot;
  if (index >= range.count) {
    return;
  }
  tree = instances[range.instance];
  const TreeVertex vertex = vertices[tree.base.x + index];
  PosedVertex result;
  result.row_x = vec4(0.0);
  result.row_y = vec4(0.0);
  result.row_z = vec4(0.0);
  for (int k = 0; k < 4; ++k) {
    const int bone = 3 * (tree.own.w + vertex.bones[k]);
    result.row_x += vertex.weights[k] * bone_rows[bone];
    result.row_y += vertex.weights[k] * bone_rows[bone + 1];
    result.row_z += vertex.weights[k] * bone_rows[bone + 2];
  }
  rows_to_world(result.row_x, result.row_y, result.row_z);
  const vec4 p = vec4(vertex.position.xyz, 1.0);
  const vec3 bare = vec3(dot(result.row_x, p), dot(result.row_y, p), dot(result.row_z, p));
  const vec3 n = vertex.normal.xyz;
  const vec3 normal =
      normalize(vec3(dot(result.row_x.xyz, n), dot(result.row_y.xyz, n), dot(result.row_z.xyz, n)));
  const float away = max(distance(bare, view.eye.xyz), 1e-6);
  const float samples = vertex.normal.w * view.eye.w / (away * view.tessellation.z);
  const float bark = vertex.position.w;
  float height = bark > 0.0 ? bark * bark_height(vertex.bark_uv.xy, samples) : 0.0;
  height += square_growth(vertex.normal.w, away);
  result.position = vec4(bare + normal * height, bark);
#ifdef SNOW
  if (has_snow()) {
    const SnowPoint point = limb_point(limb_noise(vertex.position.xyz), vertex.normal.w);
    result.position.xyz += snow_offset(point, max(snow_on(vertex), 0.0), normal);
  }
#endif
  result.normal = vec4(normal, vertex.normal.w);
  posed[tree.own.x + index] = result;
}
