// SPDX-License-Identifier: GPL-3.0-or-later
// The camera.

layout(std140, binding = 2) uniform View {
  mat4 view_projection;
  vec3 eye;
  float pixels_at_one_metre; // height of the picture / (2 tan(field of view / 2))
};
