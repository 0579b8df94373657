// A pixel of a mesh, lit from both sides.
//
// SNOW: white where the map has snow. IS_SNOW: the mesh is a snow surface.
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
in vec3 own_position;
/// Depth in metres at which snow has its full bumps and glints.
const float kDeepSnow = 0.1;

/// A pixel of a snow surface, whose normal always points outwards. At silhouettes, some visible triangles have vertex
/// normals that point away from the eye. Flipped normals would show as dark specks, so these normals are rotated until
/// they are perpendicular to the view direction.
vec3 lit_surface() {
  const vec3 to_eye = normalize(view.eye.xyz - world);
  const vec3 normal = normalize(smooth_normal);
  return lit_snow(world, normalize(normal - min(dot(normal, to_eye), 0.0) * to_eye), kDeepSnow, own_position);
}
#endif

vec3 lit_image(vec3 albedo) {
#ifdef IS_SNOW
  return lit_surface();
#else
  vec3 face = cross(dFdx(world), dFdy(world));
  face *= dot(face, view.eye.xyz - world) < 0.0 ? -1.0 : 1.0;
  // Screen-space derivatives of a triangle seen edge-on are undefined.
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
