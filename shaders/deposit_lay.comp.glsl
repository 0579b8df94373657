// Third part of the deposit: texels that together cover less than half of their pixel take no more than
// half a pixel would hold; the rest (everything, where none takes part) goes to the texel under the
// pixel's centre and, where that one is small, to its neighbours.
#include "packed_pixel.h"
#include "pixel_counts.h"
#include "texel_spread.h"
#include "triangle_object.h"

layout(local_size_x = 64) in;
layout(std430) readonly buffer ListSize { uint list_groups; uint list_groups_y; uint list_groups_z; uint list_count; };
layout(std430) readonly buffer PixelList { uint pixel_list[]; };
/// Thickness in units of step depth / kDepthUnits, saturating.
layout(std430) buffer DepositUnits { uint deposit_units[]; };
uniform usampler2D weight_sum;
uniform bool counting;
uniform float step_depth;

void add_saturating(uint texel, uint units) {
  uint seen = deposit_units[texel];
  uint before;
  do {
    before = seen;
    const uint after = before > kNowhere - units ? kNowhere : before + units;
    seen = atomicCompSwap(deposit_units[texel], before, after);
  } while (seen != before);
}

/// Lays `volume` evenly on the texel and, where it is small, on its neighbours.
void lay(float volume, int texel) {
  const ivec3 place = place_of(texel);
  const uint chart = texelFetch(owners, place, 0).y >> 8u;
  float area;
  const int reach = spread_reach(texel, place, chart, area);
  const uint units = uint(min(volume / area / step_depth * kDepthUnits + 0.5, 4294967040.0));
  add_saturating(uint(texel), units);
  const int width = 2 * reach + 1;
  for (int i = 0; i < width * width && reach > 0; ++i) {
    const ivec2 offset = ivec2(i % width, i / width) - reach;
    const int other = offset == ivec2(0) ? -1 : sharing_texel(place + ivec3(offset, 0), chart);
    if (other >= 0) {
      add_saturating(uint(other), units);
    }
  }
}

void main() {
  const uint stride = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  for (uint i = gl_GlobalInvocationID.x; i < list_count; i += stride) {
    const ivec2 pixel = unpacked_pixel(pixel_list[i]);
    const uint triangle = texelFetch(occlusion, pixel, 0).x - 1u;
    const uint slot = object_of(triangle) & ~kReceives;
    const uint owner = texel_under(pixel, triangle, slot);
    if (owner == 0u && counting) {
      atomicAdd(counts[slot].homeless, 1u);
    }
    if (owner > batch_texels.x && owner <= batch_texels.y) {
      const float left = 1.0 - float(texelFetch(weight_sum, pixel, 0).x) / float(kPixelWeight / 2u);
      lay(left * snow_of_pixel(pixel + tile_origin) * fall.direction.w * fall.direction.w,
          int(owner - 1u - batch_texels.x));
    }
  }
}
