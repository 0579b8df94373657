// Second part of the deposit: lists the pixels whose texels cover less than half of them, for the next
// part, and counts what the sky sees of every object. Kept apart from that part because software renderers
// run every branch for every pixel.
#include "packed_pixel.h"
#include "pixel_counts.h"
#include "triangle_object.h"

layout(local_size_x = 64) in;
/// Work groups of the next part (x, 1, 1) and the number of listed pixels.
layout(std430) buffer ListSize { uint list_groups; uint list_groups_y; uint list_groups_z; uint list_count; };
/// Packed pixels.
layout(std430) writeonly buffer PixelList { uint pixel_list[]; };
uniform usampler2D occlusion;
uniform usampler2D weight_sum;
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
  // mostly one. Loops ask for their end at their end: llvmpipe runs a body once more for a test at its head.
  const int y = int(gl_WorkGroupID.y);
  const int begin = int(gl_WorkGroupID.x * kPixelsEach * 64u + gl_LocalInvocationID.x);
  const int end = min(begin + int(kPixelsEach * 64u), tile_size.x);
  uint slot = group_objects.x;
  do {
    uint next = group_objects.y;
    PixelCounts count = PixelCounts(0u, 0u, 0u, 0u);
    ivec2 pixel = ivec2(begin, y);
    do {
      const uint seen = texelFetch(occlusion, pixel, 0).x;
      const uint own = seen == 0u || pixel.x >= end ? 0u : object_of((seen & ~kBackFace) - 1u);
      const bool mine = own == (slot | kReceives);
      const bool front = mine && (seen & kBackFace) == 0u;
      next = (own & kReceives) != 0u && (own & ~kReceives) > slot ? min(next, own & ~kReceives) : next;
      count.back_facing += mine && !front ? 1u : 0u;
      count.visible += front ? 1u : 0u;
      count.snowed += front && snow_of_pixel(pixel + tile_origin) > 0.0 ? 1u : 0u;
      if (front && texelFetch(weight_sum, pixel, 0).x < kPixelWeight / 2u) {
        list(pixel);
      }
      pixel.x += 64;
    } while (pixel.x < end);
    flush(slot, count);
    slot = next;
  } while (slot < group_objects.y);
}
