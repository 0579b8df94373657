// Adds the step's deposit to the map and lets slide what the slope cannot hold: equation 4.2.2 of
// D. T. Reynolds, Real-Time Rendering and Simulation of Trees and Snow, 2014, solved in closed form,
// so that the result does not depend on the length of a step.
#include "snow_shared.h"

layout(local_size_x = 64) in;
layout(std430) readonly buffer TriangleSurface { vec4 triangle_surface[]; };
layout(std430) readonly buffer Texels { Texel texels[]; };
layout(std430) readonly buffer TexelSurface { vec4 texel_surface[]; };
/// Both are read and left at 0 for the next step.
layout(std430) buffer DepositShare { float deposit_share[]; };
layout(std430) buffer DepositUnits { uint deposit_units[]; };
/// A work group's sums: deposited, slid and held volume in m3, number of saturated texels.
layout(std430) writeonly buffer Partials { vec4 partials[]; };
layout(r32f) uniform image2DArray height_map;
uniform float step_depth;
uniform float max_depth;
/// Seconds; the half-life is positive.
uniform float dt;
uniform float half_life;

shared vec4 sums[gl_WorkGroupSize.x];

/// (1 - 2^(-t / half_life)) / (t ln 2 / half_life): the part of a steady deposit that stays.
float staying_part(float t) {
  const float x = 0.69314718 * t / half_life;
  return x < 1e-2 ? 1.0 - x * (0.5 - x * (1.0 / 6.0 - x / 24.0)) : (1.0 - exp(-x)) / x;
}

float settle(float height, float deposit, float capacity) {
  if (height >= capacity) {
    return max(0.0, capacity + (height - capacity) * exp2(-dt / half_life) +
                        deposit * staying_part(dt));
  }
  if (height + deposit <= capacity) {
    return height + deposit;
  }
  const float after_crossing = 1.0 - (capacity - height) / deposit;
  return capacity + deposit * after_crossing * staying_part(dt * after_crossing);
}

void main() {
  const uint index = gl_GlobalInvocationID.x;
  const Texel texel = texels[index];
  vec4 sum = vec4(0.0);
  if (texel.place != kNowhere) {
    const int resolution = imageSize(height_map).x;
    const uint map_texels = uint(resolution * resolution);
    const uint in_map = texel.place % map_texels;
    const ivec3 at = ivec3(in_map % uint(resolution), in_map / uint(resolution),
                           texel.place / map_texels);
    const uint units = deposit_units[index];
    const float share = deposit_share[index];
    const float deposit = share + float(units) * (step_depth / kDepthUnits);
    const float height = imageLoad(height_map, at).x;
    const float capacity = max_depth * triangle_surface[texel.triangle].z;
    const float settled = settle(height, deposit, capacity);
    if (settled != height) {
      imageStore(height_map, at, vec4(settled));
    }
    if (units != 0u) {
      deposit_units[index] = 0u;
    }
    if (share != 0.0) {
      deposit_share[index] = 0.0;
    }
    const float area = texel_surface[index].w;
    sum = vec4(deposit * area, (height + deposit - settled) * area, settled * area,
               units == kNowhere ? 1.0 : 0.0);
  }
  sums[gl_LocalInvocationID.x] = sum;
  for (uint half_width = gl_WorkGroupSize.x / 2u; half_width > 0u; half_width /= 2u) {
    barrier();
    if (gl_LocalInvocationID.x < half_width) {
      sums[gl_LocalInvocationID.x] += sums[gl_LocalInvocationID.x + half_width];
    }
  }
  if (gl_LocalInvocationID.x == 0u) {
    partials[gl_WorkGroupID.x] = sums[0];
  }
}
