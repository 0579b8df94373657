// SPDX-License-Identifier: GPL-3.0-or-later
// Bark, and snow on it. Light is one sun and a sky: put your engine's own in its place.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "snow_atlas.glsl"

layout(location = 0) in vec3 surface_position;
layout(location = 1) in vec3 surface_normal;
layout(location = 2) in vec2 surface_bark_uv;
layout(location = 3) in vec2 surface_snow_uv;
layout(location = 4) in float surface_snow;

layout(binding = 2) uniform sampler2D bark_color;
layout(std140, binding = 3) uniform Light {
  vec3 to_sun;
  float sun;
  vec3 sky;
  float alpha_cutoff; // alphaCutoff of leaves; 0: bark
};

layout(location = 0) out vec4 color;

/// Metres of snow from which on no bark shows through.
const float kCovered = 0.004;
const vec3 kSnow = vec3(0.86, 0.89, 0.93);

/// The world's normal from one in the tangent space of UVs, without tangents in the mesh: they follow from how place
/// and UVs change over the screen. M. S. Mikkelsen, Bump Mapping Unparametrized Surfaces on the GPU, JGT 15 (1), 2010.
vec3 from_tangent_space(vec3 tangent_normal, vec3 normal, vec3 place, vec2 uv) {
  vec3 across = cross(dFdy(place), normal);
  vec3 along = cross(normal, dFdx(place));
  // v of the file runs downwards: its bitangent is the other way round.
  vec3 tangent = across * dFdx(uv).x + along * dFdy(uv).x;
  vec3 bitangent = -(across * dFdx(uv).y + along * dFdy(uv).y);
  // Where the screen's y runs downwards, both gradients point backwards.
  float turned = dot(cross(dFdx(place), dFdy(place)), normal) < 0.0 ? -1.0 : 1.0;
  float size = turned * inversesqrt(max(max(dot(tangent, tangent), dot(bitangent, bitangent)), 1e-20));
  return normalize(mat3(tangent * size, bitangent * size, normal) * tangent_normal);
}

void main() {
  // Leaves are seen from both sides, and carry snow on that which is up.
  vec3 normal = normalize(surface_normal) * (gl_FrontFacing ? 1.0 : -1.0);
  float covered = smoothstep(0.0, kCovered, surface_snow);
  vec3 snow = from_tangent_space(snow_tangent_normal(surface_snow_uv), normal, surface_position, surface_snow_uv);
  normal = normalize(mix(normal, snow, covered));
  vec4 texel = texture(bark_color, surface_bark_uv);
  if (texel.a < alpha_cutoff) discard;
  vec3 base = mix(texel.rgb, kSnow, covered);
  float lit = max(dot(normal, normalize(to_sun)), 0.0);
  // Light goes round in snow: what turns away from the sun is not black.
  float wrapped = max((dot(normal, normalize(to_sun)) + 0.4) / 1.4, 0.0);
  color = vec4(base * (sun * mix(lit, wrapped, covered) + sky * (0.5 + 0.5 * normal.y)), 1.0);
}
