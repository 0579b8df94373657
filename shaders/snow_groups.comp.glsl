// Marks the groups of texels onto which snow has moved. One invocation per texel.
#include "lib/snow_shared.h"
#include "glsl/texel_place.glsl"

layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(r32f) readonly uniform image2DArray height_map;
uniform usamplerBuffer places;
uniform int texel_count;
layout(std430) buffer GroupStates { uint group_states[]; };

void main() {
  const int texel = item_index();
  const uint place = texel < texel_count ? texelFetch(places, texel).x : kNowhere;
  if (place == kNowhere || (group_states[texel / int(kTexelGroup)] & kHoldsSnow) != 0u) {
    return;
  }
  const int resolution = imageSize(height_map).x;
  if (imageLoad(height_map, decoded_place(place, resolution, 1.0 / float(resolution))).x != 0.0) {
    atomicOr(group_states[texel / int(kTexelGroup)], kHoldsSnow);
  }
}
