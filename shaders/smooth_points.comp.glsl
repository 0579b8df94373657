// Evaluates smooth points, see smooth_points.h: first their normals (with NORMALS), then their snow.
#include "lib/smooth_points.h"

layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(std430) writeonly buffer Points { vec4 points[]; };
uniform int count;

void main() {
  const int point = item_index();
  if (point >= count) {
    return;
  }
#ifdef NORMALS
  points[point] = smooth_normal(point);
#else
  points[point] = smooth_point(point);
#endif
}
