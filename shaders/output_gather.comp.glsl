// Puts a stored map's heights into the output map and into the line arrays that the filters work on
// (native/snow/seam_table.h).
layout(local_size_x = 64) in;
#include "item_index.h"
layout(std430) readonly buffer Texels { int texels[]; };
layout(std430) readonly buffer PlaceU { int place_u[]; };
layout(std430) readonly buffer PlaceV { int place_v[]; };
layout(std430) writeonly buffer LineU { float line_u[]; };
layout(std430) writeonly buffer LineV { float line_v[]; };
layout(std430) writeonly buffer Map { float map[]; };
uniform sampler2DArray height_maps;
uniform int layer;
uniform int count;

void main() {
  const int index = item_index();
  if (index >= count) {
    return;
  }
  const int texel = texels[index];
  const int resolution = textureSize(height_maps, 0).x;
  const float height =
      texelFetch(height_maps, ivec3(texel % resolution, texel / resolution, layer), 0).x;
  map[texel] = height;
  line_u[place_u[index]] = height;
  line_v[place_v[index]] = height;
}
