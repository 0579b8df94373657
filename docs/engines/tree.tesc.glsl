// SPDX-License-Identifier: GPL-3.0-or-later
// How fine: T = T_p * (1 - level / levels), from an edge's own two points alone, so that both its triangles agree.
#version 450
#extension GL_GOOGLE_include_directive : require
layout(vertices = 3) out;
#include "view.glsl"

layout(location = 0) in vec3 world_position[];
layout(location = 1) in vec3 world_normal[];
layout(location = 2) in vec2 vertex_bark_uv[];
layout(location = 3) in vec2 vertex_snow_uv[];
layout(location = 4) in float vertex_level[];
layout(location = 5) in vec3 rest_position[];
layout(location = 6) in float vertex_width[];

layout(location = 0) out vec3 patch_position[];
layout(location = 1) out vec3 patch_normal[];
layout(location = 2) out vec2 patch_bark_uv[];
layout(location = 3) out vec2 patch_snow_uv[];
layout(location = 4) out vec3 patch_rest[];
layout(location = 5) out float patch_width[];

layout(std140, binding = 1) uniform Tessellation {
  float branch_levels; // branch_levels in the scene's extras
  float target_pixels; // length of a part of an edge
  float highest;       // at most so many parts, up to 64
  float snow_share;    // 0: no snow; 1: what faces up is as fine as the trunk
};

/// T_p: into how many parts an edge goes by what it covers on the screen.
float parts_on_screen(vec3 a, vec3 b) {
  float away = max(distance(eye, 0.5 * (a + b)), 0.01);
  return distance(a, b) * pixels_at_one_metre / (away * target_pixels);
}

float edge_level(int a, int b) {
  float level = min(vertex_level[a], vertex_level[b]);
  float share = 1.0 - level / branch_levels;
  // Snow rounds what lies flat, on twigs as well.
  float up = max(world_normal[a].y, world_normal[b].y);
  share = max(share, snow_share * max(up, 0.0));
  return clamp(parts_on_screen(world_position[a], world_position[b]) * share, 1.0, highest);
}

void main() {
  patch_position[gl_InvocationID] = world_position[gl_InvocationID];
  patch_normal[gl_InvocationID] = world_normal[gl_InvocationID];
  patch_bark_uv[gl_InvocationID] = vertex_bark_uv[gl_InvocationID];
  patch_snow_uv[gl_InvocationID] = vertex_snow_uv[gl_InvocationID];
  patch_rest[gl_InvocationID] = rest_position[gl_InvocationID];
  patch_width[gl_InvocationID] = vertex_width[gl_InvocationID];
  if (gl_InvocationID == 0) {
    // Edge k lies opposite corner k.
    gl_TessLevelOuter[0] = edge_level(1, 2);
    gl_TessLevelOuter[1] = edge_level(2, 0);
    gl_TessLevelOuter[2] = edge_level(0, 1);
    gl_TessLevelInner[0] = max(gl_TessLevelOuter[0], max(gl_TessLevelOuter[1], gl_TessLevelOuter[2]));
  }
}
