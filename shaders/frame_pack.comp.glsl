// Packs a picture's light into one word per pixel, see frame_code.h.
#include "lib/frame_code.h"

layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler2D light;
layout(r32ui) writeonly uniform uimage2D words;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, imageSize(words)))) {
    return;
  }
  const vec4 color = texelFetch(light, at, 0);
  imageStore(words, at, uvec4(packed_light(color.x, color.y, color.z, frame_dither(uint(at.x), uint(at.y)))));
}
