#pragma once

// The step's projection for the passes, and which pixels of the grid give snow.
#include "kernel.h"
#include "snow_shared.h"

KERNEL_UNIFORM_BLOCK(Projection, ProjectionFrame, projection);

/// pcg3d: M. Jarzynski, M. Olano, Hash Functions for GPU Rendering, JCGT 9(3), 2020.
uvec3 pcg3d(uvec3 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v ^= v >> 16u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  return v;
}

/// Whether a pixel of the grid gives snow in this step: with the probability of the noise density, from seed, step and
/// grid pixel alone. WITHOUT_NOISE: for a density of 1.
bool gives_snow(ivec2 local_pixel) {
#ifdef WITHOUT_NOISE
  return true;
#else
  const float density = noise_density(projection);
  if (density >= 1.0f) {
    return true;
  }
  const uvec2 pixel = uvec2(local_pixel + projection.base);
  const uint random = pcg3d(uvec3(pixel, projection.seed ^ (projection.step_number * 0x9E3779B9u))).x;
  return float(random >> 8u) * (1.0f / 16777216.0f) < density;
#endif
}

/// Thickness, perpendicular to the fall, of the snow in a pixel that gives snow in this step: depth / |d.z|, divided by
/// the fraction of pixels that do.
float snow_thickness() { return snow_depth(projection) / min(noise_density(projection), 1.0f); }
