// SPDX-License-Identifier: GPL-3.0-or-later
// Bark and leaves, and snow on them. Light is one sun and a sky: put your engine's own in its place.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "view.glsl"
#include "snow_atlas.glsl"
#include "snow_shading.glsl"

layout(location = 0) in vec3 surface_position;
layout(location = 1) in vec3 surface_normal;
layout(location = 2) in vec2 surface_bark_uv;
layout(location = 3) in vec2 surface_snow_uv;
layout(location = 4) in vec3 surface_rest;
layout(location = 5) in vec4 surface_noise;
layout(location = 6) in float surface_width;

layout(binding = 2) uniform sampler2D bark_color;
layout(std140, binding = 3) uniform Light {
  vec3 to_sun;
  float sun;
  vec3 sky;           // from straight above
  float alpha_cutoff; // alphaCutoff of leaves; 0: bark
  vec3 ground;        // from straight below
};

layout(location = 0) out vec4 color;

/// Fraction of the light that a leaf transmits.
const float kThrough = 0.4;
/// Fraction of the snow's own slopes that shows: twigs are only a few texels wide.
const float kTwigRelief = 0.6;

void main() {
  vec4 texel = texture(bark_color, surface_bark_uv);
  if (texel.a < alpha_cutoff) discard;
  view = SnowView(vec4(z_up(eye), pixels_at_one_metre), z_up(normalize(to_sun)), vec3(sun), sky, ground);
  vec3 place = z_up(surface_position);
  vec3 rest = z_up(surface_rest);
  vec3 outside = normalize(surface_normal);
  // Leaves are seen from both sides.
  vec3 normal = z_up(gl_FrontFacing ? outside : -outside);
  float facing = dot(normal, view.sun_direction);
  float through = alpha_cutoff > 0.0 ? kThrough : 0.0;
  float lit = sun * (max(facing, 0.0) + through * max(-facing, 0.0));
  vec3 bare = texel.rgb * (lit + mix(ground, sky, 0.5 + 0.5 * normal.z));
  float height = shown_snow(surface_noise, surface_width, surface_snow_uv, outside).height;
  vec3 snow_normal = normalize(mix(normal, with_relief(place, normal, height), kTwigRelief));
  float pixel = distance(view.eye.xyz, place) / pixels_at_one_metre;
  vec3 snow = lit_snow(place, snow_normal, height, rest);
  color = vec4(mix(bare, snow, snow_cover(height, rest, pixel)), 1.0);
}
