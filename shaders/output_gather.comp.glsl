// Puts a map's heights into the line arrays that the filters work on (native/snow/seams/seam_table.h). With
// FROM_TEXTURE the heights come from the stored maps and go into the output map as well.
layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(std430) readonly buffer Texels { int texels[]; };
layout(std430) readonly buffer PlaceU { int place_u[]; };
layout(std430) readonly buffer PlaceV { int place_v[]; };
layout(std430) writeonly buffer LineU { float line_u[]; };
layout(std430) writeonly buffer LineV { float line_v[]; };
layout(std430) buffer Map { float map[]; };
#ifdef FROM_TEXTURE
uniform sampler2DArray height_maps;
uniform int layer;
#endif
uniform int count;

void main() {
  const int index = item_index();
  if (index >= count) {
    return;
  }
  const int texel = texels[index];
#ifdef FROM_TEXTURE
  const int resolution = textureSize(height_maps, 0).x;
  const float height =
      texelFetch(height_maps, ivec3(texel % resolution, texel / resolution, layer), 0).x;
  map[texel] = height;
#else
  const float height = map[texel];
#endif
  line_u[place_u[index]] = height;
  line_v[place_v[index]] = height;
}
