// SPDX-License-Identifier: GPL-3.0-or-later
// Skinning: what engines do by themselves. Tessellation comes after it, so limbs bend first and are rounded then.
#version 450

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 bark_uv;       // TEXCOORD_0
layout(location = 3) in vec2 snow_uv;       // TEXCOORD_1
layout(location = 4) in float branch_level; // _BRANCH_LEVEL
layout(location = 5) in uvec4 joints;       // JOINTS_0
layout(location = 6) in vec4 weights;       // WEIGHTS_0
layout(location = 7) in float limb_width;   // _LIMB_WIDTH

/// A joint's world matrix times its inverse bind matrix.
layout(std430, binding = 0) readonly buffer Palette { mat4 palette[]; };

layout(location = 0) out vec3 world_position;
layout(location = 1) out vec3 world_normal;
layout(location = 2) out vec2 vertex_bark_uv;
layout(location = 3) out vec2 vertex_snow_uv;
layout(location = 4) out float vertex_level;
layout(location = 5) out vec3 rest_position;
layout(location = 6) out float vertex_width;

void main() {
  mat4 skin = weights.x * palette[joints.x] + weights.y * palette[joints.y] + weights.z * palette[joints.z] +
              weights.w * palette[joints.w];
  world_position = vec3(skin * vec4(position, 1.0));
  world_normal = normalize(mat3(skin) * normal);
  vertex_bark_uv = bark_uv;
  vertex_snow_uv = snow_uv;
  vertex_level = branch_level;
  rest_position = position;
  vertex_width = limb_width;
}
