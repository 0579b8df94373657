// GLSL only: which texels share a pixel's snow when the texel under its centre is much smaller than the
// pixel. On a twig a hundredth of a pixel thick a rare hit brings a whole pixel's snow; laid on one
// texel it would stand there as a spike. Both formulations of the deposit include it.
#include "small_texel.h"
#include "texel_place.h"

uniform usamplerBuffer texels;
/// See map_store.h.
uniform usampler2DArray owners;
/// A TexelStep each; z: area in m2.
uniform samplerBuffer texel_steps;
/// See triangle_fall.h.
uniform samplerBuffer triangle_surface;
/// Texels of the group in this batch: [first, end). An object's texels share a batch unless they fill
/// one alone, so the result does not depend on other objects.
uniform uvec2 batch_texels;

/// Texels in each direction that may share.
const int kSpreadReach = 4;

/// Column, row and layer of a texel of this batch.
ivec3 place_of(int texel) {
  const int resolution = textureSize(owners, 0).x;
  return decoded_place(texelFetch(texels, texel).y, resolution, 1.0 / float(resolution));
}

/// The texel at `at` as index in this batch if it belongs to the chart and faces the fall, else -1.
int sharing_texel(ivec3 at, uint chart) {
  if (any(lessThan(at.xy, ivec2(0))) || any(greaterThanEqual(at.xy, textureSize(owners, 0).xy))) {
    return -1;
  }
  const uvec2 owner = texelFetch(owners, at, 0).xy;
  if (owner.x == 0u || owner.y >> 8u != chart || owner.x - 1u < batch_texels.x ||
      owner.x - 1u >= batch_texels.y) {
    return -1;
  }
  const int texel = int(owner.x - 1u - batch_texels.x);
  const uint triangle = texelFetch(texels, texel).x;
  return texelFetch(triangle_surface, int(triangle)).x > 0.0 ? texel : -1;
}

/// How many texels in each direction from `texel` share, 0 = it alone; `area`: what they have together.
int spread_reach(int texel, ivec3 place, uint chart, out float area) {
  area = texelFetch(texel_steps, texel).z;
  int reach = 0;
  while (is_small(area) && reach < kSpreadReach) {
    ++reach;
    for (int y = -reach; y <= reach; ++y) {
      // Only the ring that this reach adds.
      const int step = abs(y) == reach ? 1 : 2 * reach;
      for (int x = -reach; x <= reach; x += step) {
        const int other = sharing_texel(place + ivec3(x, y, 0), chart);
        area += other < 0 ? 0.0 : texelFetch(texel_steps, other).z;
      }
    }
  }
  return reach;
}
