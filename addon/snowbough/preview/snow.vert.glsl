// SPDX-License-Identifier: GPL-3.0-or-later
// A point of the snow surface, which the native module computes; metres in the world.

void main() {
  snow_normal = normal;
  gl_Position = view_projection * vec4(place, 1.0);
  // In front of what it lies on, by as little as a depth buffer of 24 bits can tell.
  gl_Position.z -= DEPTH_BIAS * gl_Position.w;
}
