// A pixel of a mesh, lit from both sides.
//
// SNOW: white where its map says that snow lies. IS_SNOW: it is the surface of snow.
#include "glsl/image_fragment.glsl"
#ifndef SHADOW
#ifndef WIRE
in vec3 smooth_normal;
#ifdef SNOW
in vec2 snow_uv;
#include "glsl/lying_snow.glsl"
#endif
#ifdef IS_SNOW
#include "glsl/snow_shading.glsl"
in vec3 own_place;
/// Metres from which on snow has all of its relief and glints.
const float kDeepSnow = 0.1;

/// A pixel of the snow's surface, whose normal always points out of it. At its outline triangles are seen whose
/// corners' normals point away from the eye: mirrored they would be dark specks, so they are turned until they are seen
/// on edge.
vec3 lit_surface() {
  const vec3 to_eye = normalize(view.eye.xyz - world);
  const vec3 normal = normalize(smooth_normal);
  return lit_snow(world, normalize(normal - min(dot(normal, to_eye), 0.0) * to_eye), kDeepSnow, own_place);
}
#endif

vec3 lit_image(vec3 albedo) {
#ifdef IS_SNOW
  return lit_surface();
#else
  vec3 face = cross(dFdx(world), dFdy(world));
  face *= dot(face, view.eye.xyz - world) < 0.0 ? -1.0 : 1.0;
  // Screen derivatives of a triangle seen edge-on are undefined.
  vec3 normal = normalize(smooth_normal);
  const float size = length(face);
  face = size > 0.0 ? face / size : normal;
  normal *= dot(normal, face) < 0.0 ? -1.0 : 1.0;
#ifdef SNOW
  const Snow snow = lying_snow(snow_uv, world, normal, face);
  albedo = mix(albedo, kPaintedSnow, snow.cover);
  normal = normalize(mix(normal, snow.normal, snow.cover));
#endif
  return lit(albedo, world, face, normal, 0.0);
#endif
}
#endif
#endif
