// Counts what the sky sees of every object.
// WALKERS: invocations of a work group; see snow/walkers.h.
#include "pixel_counts.h"
#include "tile_pixel.h"
#include "triangle_object.h"

layout(local_size_x = WALKERS) in;
/// A SeenPixel each.
uniform usamplerBuffer occlusion;

void main() {
  // A work group walks along a row, each lane every WALKERS-th pixel.
  const int y = int(gl_WorkGroupID.y) + kTileMargin;
  const int begin = int(gl_WorkGroupID.x * kRowRun + gl_LocalInvocationID.x) + kTileMargin;
  const int end = min(int((gl_WorkGroupID.x + 1u) * kRowRun), tile_size.x - 2 * kTileMargin) + kTileMargin;
  uint current = 0u;
  PixelCounts count = PixelCounts(0u, 0u);
  for (ivec2 pixel = ivec2(begin, y); pixel.x < end; pixel.x += WALKERS) {
    const uint seen = texelFetch(occlusion, pixel_index(pixel)).x;
    const uint object = seen == 0u ? 0u : object_of((seen & ~kBackFace) - 1u);
    if ((object & kReceives) == 0u) {
      continue;
    }
    const uint slot = object & ~kReceives;
    if (slot != current) {
      flush(current, count);
      current = slot;
    }
    if ((seen & kBackFace) != 0u) {
      count.back_facing += 1u;
    } else {
      count.visible += 1u;
    }
  }
  flush(current, count);
}
