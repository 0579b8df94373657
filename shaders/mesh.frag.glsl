// A pixel of a mesh: its colour times its image, with holes where that is less than half there; lit from both sides.
//
// SHADOW: depth alone. WIRE: one colour, unlit. SNOW: white where its map says that snow lies.
uniform sampler2D image;
in vec2 image_uv;
#ifndef SHADOW
layout(location = 0) out vec4 color;
#ifdef WIRE
uniform vec4 wire_color;
#else
#include "glsl/lighting.glsl"
/// Linear; times that of the image.
uniform vec4 mesh_color;
in vec3 world;
in vec3 smooth_normal;
#ifdef SNOW
in vec2 snow_uv;
#include "glsl/lying_snow.glsl"
#endif
#endif
#endif

void main() {
  const vec4 texel = texture(image, image_uv);
  if (texel.a < 0.5) {
    discard;
  }
#ifndef SHADOW
#ifdef WIRE
  color = wire_color;
#else
  vec3 face = cross(dFdx(world), dFdy(world));
  face *= dot(face, view.eye.xyz - world) < 0.0 ? -1.0 : 1.0;
  // Where a triangle is seen on edge its screen derivatives say nothing.
  vec3 normal = normalize(smooth_normal);
  const float size = length(face);
  face = size > 0.0 ? face / size : normal;
  normal *= dot(normal, face) < 0.0 ? -1.0 : 1.0;
  vec3 albedo = texel.rgb * mesh_color.rgb;
#ifdef SNOW
  const Snow snow = lying_snow(snow_uv, world, normal, face);
  albedo = mix(albedo, kSnowAlbedo, snow.cover);
  normal = normalize(mix(normal, snow.normal, snow.cover));
#endif
  color = encoded(lit(albedo, world, face, normal, 0.0));
#endif
#endif
}
