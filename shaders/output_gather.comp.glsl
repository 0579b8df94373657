// Copies a map's heights to the line arrays that cross seams (native/snow/seams/seam_table.h).
layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(std430) readonly buffer Texels { int texels[]; };
layout(std430) readonly buffer PlaceU { int place_u[]; };
layout(std430) readonly buffer PlaceV { int place_v[]; };
layout(std430) writeonly buffer LineU { float line_u[]; };
layout(std430) writeonly buffer LineV { float line_v[]; };
layout(std430) readonly buffer Map { float map[]; };
uniform int count;

void main() {
  const int index = item_index();
  if (index >= count) {
    return;
  }
  const int texel = texels[index];
  const float height = map[texel];
  line_u[place_u[index]] = height;
  line_v[place_v[index]] = height;
}
