// Moves the tessellator's vertices onto the limbs' round surface and their bark.
#include "glsl/tree_surface.glsl"
#include "glsl/tree_outputs.glsl"
#include "glsl/inset_normal.glsl"

layout(quads, fractional_odd_spacing, ccw) in;
patch in ivec2 drawn_patch;

void main() {
  const vec2 at = gl_TessCoord.xy;
  tree = instances[drawn_patch.x];
  const TreePatch of = patches[tree.base.z + drawn_patch.y];
  const SurfacePoint point = patch_point(of, at);
#ifdef CAPTURE
  captured = point.position;
#else
#ifndef SHADOW
  world = point.position;
  smooth_normal = shading_normal(of, at, point.normal);
  bark = vec4(patch_bark_uv(of, at), point.limb);
#ifdef IMAGE
  const BarkUv uv = bark_uvs[tree.lists.y + drawn_patch.y];
  image_uv = vec3(patch_uv(uv.uv_01, uv.uv_23, at), uv.layer.x);
#endif
#ifndef WIRE
  drawn_tree = drawn_patch.x;
#ifdef SNOW
  snow_map = tree.map;
  snow_depths = tree.snow;
  snow_style = tree.style;
  snow_uv = patch_snow_uv(of, at);
  rest_position = point.rest;
  snow_noises = point.noise;
#endif
#endif
#endif
#endif
  gl_Position = view.clip_from_world * vec4(point.position, 1.0);
}
