// Puts the tessellator's vertices onto the limbs' round surface and their bark.
//
// CAPTURE: hands world positions to transform feedback. SHADOW: the sun's picture, of depth alone.
#include "glsl/tree_surface.glsl"

/// Plain and tessellated patches meet: both programs compute it to the same bits.
invariant gl_Position;
layout(quads, fractional_odd_spacing, ccw) in;
patch in uint patch_index;
#ifdef CAPTURE
layout(xfb_buffer = 0, xfb_offset = 0, xfb_stride = 12) out vec3 captured;
#else
#ifndef SHADOW
out vec3 world;
out vec3 smooth_normal;
out vec4 bark;
#ifdef IMAGE
layout(std430) readonly buffer BarkPlaces { BarkPlace bark_places[]; };
/// Coordinates of the bark's image, and its layer.
out vec3 image_place;
#endif
#ifdef SNOW
#ifndef WIRE
/// Where the snow is on its map, and the bark in the rest pose.
out vec2 snow_place;
out vec3 rest_place;
#endif
#endif
#endif
#endif

void main() {
  const vec2 at = gl_TessCoord.xy;
  const TreePatch of = patches[patch_index];
  const SurfacePoint point = patch_point(of, at);
#ifdef CAPTURE
  captured = point.position;
#else
#ifndef SHADOW
  world = point.position;
  smooth_normal = point.normal;
  bark = vec4(patch_bark_uv(of, at), point.limb);
#ifdef IMAGE
  const BarkPlace place = bark_places[patch_index];
  image_place = vec3(patch_uv(place.uv_01, place.uv_23, at), place.layer.x);
#endif
#ifdef SNOW
#ifndef WIRE
  snow_place = patch_snow_uv(of, at);
  rest_place = point.rest;
#endif
#endif
#endif
#endif
  gl_Position = view.clip_from_world * vec4(point.position, 1.0);
}
