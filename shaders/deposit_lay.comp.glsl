// Third part of the deposit: texels that together cover less than half of their pixel take no more than
// half a pixel would hold; the rest (everything, where none takes part) goes to the texel under the
// pixel's centre. Where that one is small, the next part lays it on its neighbours, too.
#include "deposit_units.h"
#include "packed_pixel.h"
#include "pixel_counts.h"
#include "small_texel.h"
#include "texel_under.h"
#include "triangle_object.h"

layout(local_size_x = 64) in;
layout(std430) readonly buffer PixelListSize { ListSize pixel_list_size; };
layout(std430) readonly buffer PixelList { uint pixel_list[]; };
layout(std430) buffer SpreadListSize { ListSize spread_size; };
layout(std430) writeonly buffer SpreadList { SpreadSnow spread_list[]; };
uniform usamplerBuffer weight_sum;
/// A TexelStep each; z: area in m2.
uniform samplerBuffer texel_steps;
/// Texels of the group in this batch: [first, end).
uniform uvec2 batch_texels;
uniform bool counting;

void spread_later(int texel, float volume) {
  const uint at = atomicAdd(spread_size.count, 1u);
  spread_list[at] = SpreadSnow(uint(texel), volume);
  if (at % kBlock == 0u && at / kBlock < kMostGroups) {
    atomicAdd(spread_size.groups_x, 1u);
  }
}

void main() {
  const uint stride = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  uint i = gl_GlobalInvocationID.x;
  if (i >= pixel_list_size.count) {
    return;
  }
  do {
    const ivec2 pixel = unpacked_pixel(pixel_list[i]);
    const uint triangle = texelFetch(occlusion, pixel_index(pixel)).x - 1u;
    const uint slot = object_of(triangle) & ~kReceives;
    const uint owner = texel_under(pixel, triangle, slot);
    if (owner == 0u && counting) {
      atomicAdd(counts[slot].homeless, 1u);
    }
    if (owner > batch_texels.x && owner <= batch_texels.y) {
      const int texel = int(owner - 1u - batch_texels.x);
      const float left = 1.0 - float(texelFetch(weight_sum, pixel_index(pixel)).x) / float(kPixelWeight / 2u);
      const float volume = left * snow_of_pixel(pixel + tile_origin) * fall.direction.w * fall.direction.w;
      const float area = texelFetch(texel_steps, texel).z;
      if (is_small(area)) {
        spread_later(texel, volume);
      } else {
        add_to_texel(texel, volume / area);
      }
    }
    i += stride;
  } while (i < pixel_list_size.count);
}
