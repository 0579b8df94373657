#pragma once

// Gradient noise on a lattice, for C++ and GLSL. A hash of the lattice point gives the gradient, so that both languages
// give the same noise without a table.
//
// Sources: K. Perlin, Improving Noise, SIGGRAPH 2002 (gradient noise, the fade of degree five); M. Jarzynski,
// M. Olano, Hash Functions for GPU Rendering, JCGT 9 (3), 2020 (pcg3d).
#include "shared_functions.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// The unit gradient at a lattice point.
SNOWBOUGH_SHARED_FUNCTION vec3 lattice_gradient(vec3 at) {
  // The conversion goes through int, because a negative float has no unsigned value.
  uint x = uint(int(at.x)) * 1664525u + 1013904223u;
  uint y = uint(int(at.y)) * 1664525u + 1013904223u;
  uint z = uint(int(at.z)) * 1664525u + 1013904223u;
  x += y * z;
  y += z * x;
  z += x * y;
  x ^= x >> 16u;
  y ^= y >> 16u;
  z ^= z >> 16u;
  x += y * z;
  y += z * x;
  z += x * y;
  const vec3 gradient = vec3(float(x >> 8u), float(y >> 8u), float(z >> 8u)) * (2.0f / 16777216.0f) - vec3(1.0f);
  return gradient * (1.0f / max(length(gradient), 1e-4f));
}

SNOWBOUGH_SHARED_FUNCTION float lattice_share(vec3 cell, vec3 in_cell, vec3 corner) {
  return dot(lattice_gradient(cell + corner), in_cell - corner);
}

/// Noise from about -1 to 1 with a mean of 0. The wavelength is about 1.
SNOWBOUGH_SHARED_FUNCTION float gradient_noise(vec3 position) {
  // Farther out, floats have no fractions, and an int no such number.
  const vec3 bounded = clamp(position, vec3(-1e9f), vec3(1e9f));
  const vec3 cell = floor(bounded);
  const vec3 f = bounded - cell;
  const vec3 w = f * f * f * (f * (f * 6.0f - vec3(15.0f)) + vec3(10.0f));
  float along_z[2];
  for (int k = 0; k < 2; ++k) {
    const float z = float(k);
    const float a = lattice_share(cell, f, vec3(0.0f, 0.0f, z));
    const float b = lattice_share(cell, f, vec3(1.0f, 0.0f, z));
    const float c = lattice_share(cell, f, vec3(0.0f, 1.0f, z));
    const float d = lattice_share(cell, f, vec3(1.0f, 1.0f, z));
    const float near = a + w.x * (b - a);
    const float far = c + w.x * (d - c);
    along_z[k] = near + w.y * (far - near);
  }
  return 1.6f * (along_z[0] + w.z * (along_z[1] - along_z[0]));
}

/// Three octaves of gradient noise, scaled to the variance of one octave. `waves`: wavelengths in the unit of
/// `position`; an octave with wavelength 0 is skipped. `gain`: ratio of an octave's amplitude to that of the octave
/// before.
SNOWBOUGH_SHARED_FUNCTION float layered_noise(vec3 position, vec3 waves, float gain) {
  float sum = gradient_noise(position * (1.0f / waves.x));
  float squares = 1.0f;
  if (waves.y > 0.0f) {
    sum += gain * gradient_noise(position * (1.0f / waves.y) + vec3(17.3f));
    squares += gain * gain;
  }
  if (waves.z > 0.0f) {
    sum += gain * gain * gradient_noise(position * (1.0f / waves.z) + vec3(34.6f));
    squares += gain * gain * gain * gain;
  }
  return sum / sqrt(squares);
}

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
