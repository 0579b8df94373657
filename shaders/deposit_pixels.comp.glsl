// Second part of the deposit: texels that together cover less than half of their pixel take no more
// than half a pixel would hold; the rest (everything, where none takes part) goes to the texel under
// the pixel's centre. Counts what the sky sees of every object.
#include "pixel_counts.h"
#include "texel_under.h"

layout(local_size_x = 64) in;
/// Thickness in units of step depth / kDepthUnits, saturating.
layout(std430) buffer DepositUnits { uint deposit_units[]; };
uniform samplerBuffer texel_surface;
uniform usampler2D weight_sum;
/// Texels of the group in this batch: [first, end).
uniform uvec2 batch_texels;
uniform bool counting;
uniform ivec2 tile_size;
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

/// Puts what a pixel's texels do not take onto the texel under its centre; true when there is none.
bool is_homeless(ivec2 pixel, uint triangle, uint slot) {
  const uint half_pixel = kPixelWeight / 2u;
  const uint sum = texelFetch(weight_sum, pixel, 0).x;
  if (sum >= half_pixel) {
    return false;
  }
  const uint owner = texel_under(pixel, triangle, slot);
  if (owner == 0u) {
    return true;
  }
  const uint texel = owner - 1u;
  if (texel >= batch_texels.x && texel < batch_texels.y) {
    const float left = 1.0 - float(sum) / float(half_pixel);
    const float area = texelFetch(texel_surface, int(texel - batch_texels.x)).w;
    const float thickness =
        left * snow_of_pixel(pixel + tile_origin) * fall.direction.w * fall.direction.w / area;
    add_saturating(texel - batch_texels.x,
                   uint(min(thickness / step_depth * kDepthUnits + 0.5, 4294967040.0)));
  }
  return false;
}

void main() {
  // A work group walks along a row, each lane every 64th pixel: counts change hands rarely.
  const int y = int(gl_WorkGroupID.y);
  const int begin = int(gl_WorkGroupID.x * kPixelsEach * 64u + gl_LocalInvocationID.x);
  uint current = 0u;
  PixelCounts count = PixelCounts(0u, 0u, 0u, 0u);
  for (uint i = 0u; i < kPixelsEach; ++i) {
    const ivec2 pixel = ivec2(begin + int(i * 64u), y);
    if (pixel.x >= tile_size.x) {
      break;
    }
    const uvec4 seen = texelFetch(occlusion, pixel, 0);
    const uint slot = seen.z & ~kReceives;
    if (seen.x == 0u || (seen.z & kReceives) == 0u || slot < group_objects.x ||
        slot >= group_objects.y) {
      continue;
    }
    if (slot != current) {
      flush(current, count);
      current = slot;
    }
    if ((seen.x & kBackFace) != 0u) {
      count.back_facing += counting ? 1u : 0u;
      continue;
    }
    const bool homeless = is_homeless(pixel, seen.x - 1u, slot);
    if (counting) {
      count.visible += 1u;
      count.homeless += homeless ? 1u : 0u;
      count.snowed += snow_of_pixel(pixel + tile_origin) > 0.0 ? 1u : 0u;
    }
  }
  flush(current, count);
}
