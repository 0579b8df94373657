// Second part of the deposit: works out what a pixel gives to the texels that take part in it, lists the
// pixels whose texels cover less than half of them, for the next part, and counts what the sky sees of
// every object. Kept apart from that part because software renderers run every branch for every pixel.
#include "packed_pixel.h"
#include "pixel_counts.h"

layout(local_size_x = 64) in;
/// Work groups of the next part (x, 1, 1) and the number of listed pixels.
layout(std430) buffer ListSize { uint list_groups; uint list_groups_y; uint list_groups_z; uint list_count; };
/// Packed pixels.
layout(std430) writeonly buffer PixelList { uint pixel_list[]; };
uniform usampler2D occlusion;
uniform usampler2D weight_sum;
/// Snow in m3 for a pixel's area of texels. Texels that together cover less than half of their pixel take
/// no more than half a pixel would hold.
layout(r32f) writeonly uniform image2D pixel_share;
/// Slots of the objects whose maps are in this group: [first, end).
uniform uvec2 group_objects;
uniform ivec2 tile_origin;
uniform ivec2 tile_size;

void list(ivec2 pixel) {
  const uint at = atomicAdd(list_count, 1u);
  pixel_list[at] = packed_pixel(pixel);
  // A list that needs more groups than a dispatch may have is walked in strides.
  if (at % 64u == 0u && at / 64u < kMostGroups) {
    atomicAdd(list_groups, 1u);
  }
}

void main() {
  // A work group walks along a row, each lane every 64th pixel, once for every object in its pixels:
  // mostly one.
  const int y = int(gl_WorkGroupID.y);
  const int begin = int(gl_WorkGroupID.x * kPixelsEach * 64u + gl_LocalInvocationID.x);
  uint slot = group_objects.x;
  while (slot < group_objects.y) {
    uint next = group_objects.y;
    PixelCounts count = PixelCounts(0u, 0u, 0u, 0u);
    for (uint i = 0u; i < kPixelsEach; ++i) {
      const ivec2 pixel = ivec2(begin + int(i * 64u), y);
      if (pixel.x >= tile_size.x) {
        break;
      }
      const uvec4 seen = texelFetch(occlusion, pixel, 0);
      const uint own = seen.x == 0u ? 0u : seen.z;
      const bool mine = own == (slot | kReceives);
      const bool front = mine && (seen.x & kBackFace) == 0u;
      next = (own & kReceives) != 0u && (own & ~kReceives) > slot ? min(next, own & ~kReceives) : next;
      count.back_facing += mine && !front ? 1u : 0u;
      count.visible += front ? 1u : 0u;
      const float snow = snow_of_pixel(pixel + tile_origin);
      count.snowed += front && snow > 0.0 ? 1u : 0u;
      if (front) {
        const uint sum = texelFetch(weight_sum, pixel, 0).x;
        const float covered = float(max(sum, kPixelWeight / 2u)) / float(kPixelWeight);
        imageStore(pixel_share, pixel, vec4(snow * fall.direction.w * fall.direction.w / covered));
        if (sum < kPixelWeight / 2u) {
          list(pixel);
        }
      }
    }
    flush(slot, count);
    slot = next;
  }
}
