// A pixel of a mesh, lit from both sides.
//
// SNOW: white where its map holds snow.
#include "glsl/image_fragment.glsl"
#ifndef SHADOW
#ifndef WIRE
in vec3 smooth_normal;
#ifdef SNOW
in vec2 snow_uv;
#include "glsl/lying_snow.glsl"
#endif

vec3 lit_image(vec3 albedo) {
  vec3 face = cross(dFdx(world), dFdy(world));
  face *= dot(face, view.eye.xyz - world) < 0.0 ? -1.0 : 1.0;
  // Screen derivatives of a triangle seen edge-on are undefined.
  vec3 normal = normalize(smooth_normal);
  const float size = length(face);
  face = size > 0.0 ? face / size : normal;
  normal *= dot(normal, face) < 0.0 ? -1.0 : 1.0;
#ifdef SNOW
  const Snow snow = lying_snow(snow_uv, world, normal, face);
  albedo = mix(albedo, kSnowAlbedo, snow.cover);
  normal = normalize(mix(normal, snow.normal, snow.cover));
#endif
  return lit(albedo, world, face, normal, 0.0);
}
#endif
#endif
