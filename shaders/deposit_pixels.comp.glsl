// Second part of the deposit: lists the pixels that give snow and whose texels cover less than half of
// them, for the next part, and counts what the sky sees of every object. Kept apart from that part because
// software renderers run every branch for every pixel.
//
// WALKERS: invocations of a work group; see snow/walkers.h.
#include "packed_pixel.h"
#include "pixel_counts.h"
#include "pixel_look.h"

layout(local_size_x = WALKERS) in;
layout(std430) buffer PixelListSize { ListSize pixel_list_size; };
/// Packed pixels.
layout(std430) writeonly buffer PixelList { uint pixel_list[]; };
/// Slots of the objects whose maps are in this group: [first, end).
uniform uvec2 group_objects;

/// Lists the pixels of a walk from `pixel` whose bits are set, in one go: a counter that all invocations
/// share is slow.
void list(ivec2 pixel, uint bits) {
  const uint count = uint(bitCount(bits));
  uint at = 0u;
  if (count > 0u) {
    at = atomicAdd(pixel_list_size.count, count);
    const uint groups = min((at + count + kBlock - 1u) / kBlock, kMostGroups) -
                        min((at + kBlock - 1u) / kBlock, kMostGroups);
    if (groups > 0u) {
      atomicAdd(pixel_list_size.groups_x, groups);
    }
  }
  while (bits != 0u) {
    const int i = findLSB(bits);
    pixel_list[at] = packed_pixel(pixel + ivec2(WALKERS * i, 0));
    ++at;
    bits &= bits - 1u;
  }
}

void main() {
  // A work group walks along a row, each lane every WALKERS-th pixel, once for every object in its pixels:
  // mostly one. Loops ask for their end at their end: llvmpipe runs a body once more for a test at its head.
  const int y = int(gl_WorkGroupID.y);
  const int begin = int(gl_WorkGroupID.x * kRowRun + gl_LocalInvocationID.x);
  const int end = min(int((gl_WorkGroupID.x + 1u) * kRowRun), tile_size.x);
  uint slot = group_objects.x;
  do {
    uint next = group_objects.y;
    PixelCounts count = PixelCounts(0u, 0u, 0u, 0u);
    ivec2 pixel = ivec2(begin, y);
    do {
      const ivec2 first = pixel;
      uint bit = 1u;
      uint bare = 0u;
      do {
        const uint seen = texelFetch(occlusion, pixel_index(pixel)).x;
        const uint own = seen == 0u || pixel.x >= end ? 0u : object_of((seen & ~kBackFace) - 1u);
        const bool mine = own == (slot | kReceives);
        const bool front = mine && (seen & kBackFace) == 0u;
        next = (own & kReceives) != 0u && (own & ~kReceives) > slot ? min(next, own & ~kReceives) : next;
        count.back_facing += mine && !front ? 1u : 0u;
        count.visible += front ? 1u : 0u;
        const bool snows = front && gives_snow(pixel);
        count.snowed += snows ? 1u : 0u;
        bare |= snows && is_bare(pixel) ? bit : 0u;
        pixel.x += WALKERS;
        bit <<= 1u;
      } while (bit != 0u && pixel.x < end);
      list(first, bare);
    } while (pixel.x < end);
    flush(slot, count);
    slot = next;
  } while (slot < group_objects.y);
}
