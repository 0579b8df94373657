// SPDX-License-Identifier: GPL-3.0-or-later
// Where the new vertices lie: rounded by the normals, then moved out by the snow.
#version 450
#extension GL_GOOGLE_include_directive : require
layout(triangles, fractional_odd_spacing, ccw) in;
#include "view.glsl"
#include "snow_atlas.glsl"

layout(location = 0) in vec3 patch_position[];
layout(location = 1) in vec3 patch_normal[];
layout(location = 2) in vec2 patch_bark_uv[];
layout(location = 3) in vec2 patch_snow_uv[];
layout(location = 4) in vec3 patch_rest[];
layout(location = 5) in float patch_width[];

layout(location = 0) out vec3 surface_position;
layout(location = 1) out vec3 surface_normal;
layout(location = 2) out vec2 surface_bark_uv;
layout(location = 3) out vec2 surface_snow_uv;
layout(location = 4) out vec3 surface_rest;
layout(location = 5) out vec4 surface_noise;
layout(location = 6) out float surface_width;

/// How far a flat point goes towards the corners' tangent planes. T. Boubekeur, M. Alexa, Phong Tessellation, 2008.
const float kRoundness = 0.75;

vec3 on_plane(vec3 p, int corner) {
  return p - dot(p - patch_position[corner], patch_normal[corner]) * patch_normal[corner];
}

void main() {
  vec3 t = gl_TessCoord;
  vec3 flat_point = t.x * patch_position[0] + t.y * patch_position[1] + t.z * patch_position[2];
  vec3 round_point = t.x * on_plane(flat_point, 0) + t.y * on_plane(flat_point, 1) + t.z * on_plane(flat_point, 2);
  surface_normal = normalize(t.x * patch_normal[0] + t.y * patch_normal[1] + t.z * patch_normal[2]);
  surface_bark_uv = t.x * patch_bark_uv[0] + t.y * patch_bark_uv[1] + t.z * patch_bark_uv[2];
  surface_snow_uv = t.x * patch_snow_uv[0] + t.y * patch_snow_uv[1] + t.z * patch_snow_uv[2];
  surface_rest = t.x * patch_rest[0] + t.y * patch_rest[1] + t.z * patch_rest[2];
  surface_noise = limb_noise(surface_rest);
  surface_width = t.x * patch_width[0] + t.y * patch_width[1] + t.z * patch_width[2];
  ShownSnow snow = shown_snow(surface_noise, surface_width, surface_snow_uv, surface_normal);
  surface_position = mix(flat_point, round_point, kRoundness) + snow.offset;
  gl_Position = view_projection * vec4(surface_position, 1.0);
}
