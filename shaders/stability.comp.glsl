// The stability pass, see texel_stability.h.
//
// GAIN_IN_METRES: the gain of a TexelStep is the bits of metres, negative on backs.
// RECORD_SLID: write what slides off each texel.
// LOCAL_SIZE: work-group size, at most kMaxLocalSize; see native/snow/step/gl/driver.h.
#include "glsl/texel_group.glsl"
#include "glsl/texel_place.glsl"
#include "lib/texel_stability.h"

/// A TexelStep each.
uniform usamplerBuffer texel_steps;

layout(local_size_x = LOCAL_SIZE) in;
/// Sums per invocation, LOCAL_SIZE per group of texels, see StableTexel.
layout(std430) writeonly buffer Partials { vec4 partials[]; };
layout(r32f) uniform image2DArray height_map;
#ifdef RECORD_SLID
/// Per texel, the volume in m3 that slides off; zero before.
layout(std430) writeonly buffer Slid { float slid[]; };
#endif
/// Per group of texels; kHoldsSnow is set if it holds snow after the step.
layout(std430) buffer GroupStates { uint group_states[]; };
/// Per texel: layer * resolution^2 + row * resolution + column, kNowhere after an object's last.
uniform usamplerBuffer places;

void main() {
  // An invocation processes every LOCAL_SIZE-th texel of the work group, so that no barrier is needed.
  const int group = listed_group();
  const int begin = group * int(kTexelGroup) + int(gl_LocalInvocationID.x);
  const int resolution = imageSize(height_map).x;
  const float one_over_resolution = 1.0 / float(resolution);
  const WholeStep whole = whole_step();
  vec4 sum = vec4(0.0);
  float highest = 0.0;
  for (uint i = 0u; i < kTexelGroup; i += gl_WorkGroupSize.x) {
    const int index = begin + int(i);
    const uint place = texelFetch(places, index).x;
    if (place == kNowhere) {
      break;
    }
    const uvec4 step = texelFetch(texel_steps, index);
    const ivec3 at = decoded_place(place, resolution, one_over_resolution);
#ifdef GAIN_IN_METRES
    const float deposit = uintBitsToFloat(step.x);
#else
    const float deposit = deposit_of(step);
#endif
    const float height = imageLoad(height_map, at).x;
    const StableTexel stable = stabilise_texel(height, deposit, step, whole);
    if (stable.height != height) {
      imageStore(height_map, at, vec4(stable.height));
    }
    highest = max(highest, abs(stable.height));
    sum += stable.sums;
#ifdef RECORD_SLID
    slid[index] = stable.sums.y;
#endif
  }
  partials[group * LOCAL_SIZE + int(gl_LocalInvocationID.x)] = sum;
  if (highest > 0.0) {
    atomicOr(group_states[group], kHoldsSnow);
  }
}
