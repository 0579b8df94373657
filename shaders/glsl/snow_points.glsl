// A receiver's vertices with their snow.
#include "glsl/tree_view.glsl"
#include "lib/snow_patch.h"

layout(std430) readonly buffer SnowPoints { SnowPoint points[]; };
layout(std430) readonly buffer SnowPatches { SnowPatch patches[]; };

struct SurfacePoint {
  vec3 position;
  /// Unit: where snow grows to.
  vec3 direction;
};

SurfacePoint vertex_surface(int index) {
  return SurfacePoint(vec3(points[index].position), vec3(points[index].direction));
}
