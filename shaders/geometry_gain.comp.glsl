// Algorithm 1 of the thesis: a step's deposit as the gain of its texels: the bits of metres, negative on backs.
#include "glsl/texel_group.glsl"
#include "glsl/texel_place.glsl"

layout(local_size_x = 64) in;
uniform usamplerBuffer places;
uniform sampler2DArray deposit_map;
/// A TexelStep each, as one vector.
layout(std430) buffer TexelSteps { uvec4 texel_steps[]; };

void main() {
  const int index = listed_texel();
  const uint place = texelFetch(places, index).x;
  if (place == kNowhere) return;
  const int resolution = textureSize(deposit_map, 0).x;
  const ivec3 at = decoded_place(place, resolution, 1.0 / float(resolution));
  texel_steps[index].x = floatBitsToUint(texelFetch(deposit_map, at, 0).x);
}
