// Counts what the sky sees of every object, for the formulation without a compute pass over pixels.
#include "pixel_counts.h"
#include "tile_pixel.h"
#include "triangle_object.h"

layout(local_size_x = 64) in;
uniform usamplerBuffer occlusion;
uniform ivec2 tile_origin;

void main() {
  const int y = int(gl_WorkGroupID.y);
  const int begin = int(gl_WorkGroupID.x * kPixelsEach * 64u + gl_LocalInvocationID.x);
  uint current = 0u;
  PixelCounts count = PixelCounts(0u, 0u, 0u, 0u);
  for (uint i = 0u; i < kPixelsEach; ++i) {
    const ivec2 pixel = ivec2(begin + int(i * 64u), y);
    if (pixel.x >= tile_size.x) {
      break;
    }
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
      count.snowed += snow_of_pixel(pixel + tile_origin) > 0.0 ? 1u : 0u;
    }
  }
  flush(current, count);
}
