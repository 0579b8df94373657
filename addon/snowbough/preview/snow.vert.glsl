// SPDX-License-Identifier: GPL-3.0-or-later
// A point of the snow surface, computed by the native module, in metres in world space.

void main() {
  snow_normal = normal;
  gl_Position = view_projection * vec4(place, 1.0);
  // Offset towards the viewer: a few steps of a 24-bit depth buffer, so that snow hides the surface below it.
  gl_Position.z -= DEPTH_BIAS * gl_Position.w;
}
