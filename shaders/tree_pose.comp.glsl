// Poses the vertices of the base and adds bark.
//
// SNOW: also adds snow, from the mean of the map's heights at the vertex's coordinates.
#include "glsl/bark.glsl"
#include "glsl/tree_view.glsl"
#include "glsl/limb_growth.glsl"

layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(std430) readonly buffer TreeVertices { TreeVertex vertices[]; };
layout(std430) writeonly buffer PosedVertices { PosedVertex posed[]; };
/// Three rows of a matrix per bone, from the rest pose to the pose.
layout(std430) readonly buffer BoneRows { vec4 bone_rows[]; };
uniform int count;
#ifdef SNOW
#include "glsl/tree_snow.glsl"
layout(std430) readonly buffer VertexSnow { vec2 vertex_snow[]; };

float snow_on(TreeVertex vertex) {
  const int begin = floatBitsToInt(vertex.bark_uv.z);
  const int end = floatBitsToInt(vertex.bark_uv.w);
  float sum = 0.0;
  for (int i = begin; i < end; ++i) {
    sum += height_between(vertex_snow[i]);
  }
  return sum / float(max(end - begin, 1));
}
#endif

void main() {
  const int index = item_index();
  if (index >= count) {
    return;
  }
  const TreeVertex vertex = vertices[index];
  PosedVertex result;
  result.row_x = vec4(0.0);
  result.row_y = vec4(0.0);
  result.row_z = vec4(0.0);
  for (int k = 0; k < 4; ++k) {
    const int bone = 3 * vertex.bones[k];
    result.row_x += vertex.weights[k] * bone_rows[bone];
    result.row_y += vertex.weights[k] * bone_rows[bone + 1];
    result.row_z += vertex.weights[k] * bone_rows[bone + 2];
  }
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
  const SnowPoint point = limb_point(limb_noise(vertex.position.xyz), vertex.normal.w);
  result.position.xyz += snow_offset(point, max(snow_on(vertex), 0.0), normal);
#endif
  result.normal = vec4(normal, vertex.normal.w);
  posed[index] = result;
}
