// A pixel of the tree, plain or tessellated.
//
// SNOW: adds the snow of trees that have some. IMAGE: uses the bark's image. SHADOW: depth only. WIRE: the lines of a
// wireframe, or the background that hides the lines behind it.
#ifndef SHADOW
layout(location = 0) out vec4 color;
#ifdef WIRE
uniform vec4 wire_color;
#else
#include "glsl/bark_shading.glsl"
#include "glsl/tree_instance.glsl"
flat in int drawn_tree;
in vec3 world;
in vec3 smooth_normal;
in vec4 bark;
#ifdef IMAGE
uniform sampler2DArray bark_images;
in vec3 image_uv;
#endif
#ifdef SNOW
#include "glsl/tree_snow.glsl"
#include "glsl/snow_shading.glsl"
flat in ivec4 snow_map;
flat in vec4 snow_depths;
flat in SnowStyle snow_style;
in vec2 snow_uv;
in vec3 rest_position;
in vec4 snow_noises;

/// Fraction of the snow's own slopes that shows on limbs.
const float kTwigRelief = 0.6;

/// Blends the light of the snow over that of the bark. Limbs show no snow on their back, even if the map has some.
vec3 with_snow(vec3 bare) {
  const vec3 limb = normalize(smooth_normal);
  const float depth =
      shown_snow(limb_point(snow_noises, bark.z), max(height_between(snow_uv), 0.0), limb.z);
  // Twigs are only a few texels wide, so soften the steps between texels.
  const vec3 normal = normalize(mix(limb, with_relief(world, limb, depth), kTwigRelief));
  const float pixel = distance(view.eye.xyz, world) / view.eye.w;
  return mix(bare, lit_snow(world, normal, depth, rest_position), snow_cover(depth, rest_position, pixel));
}
#endif
#endif
#endif

void main() {
#ifndef SHADOW
#ifdef WIRE
  color = wire_color;
#else
  const vec3 relief = pixel_relief(world, bark);
#ifdef IMAGE
  const vec3 albedo = texture(bark_images, image_uv).rgb;
#else
  const vec3 albedo = mix(instances[drawn_tree].bark_dark.rgb, instances[drawn_tree].bark_light.rgb, bark_share(relief.x));
#endif
  vec3 light = shaded_bark(world, smooth_normal, bark, relief, albedo);
#ifdef SNOW
  tree.map = snow_map;
  tree.snow = snow_depths;
  tree.style = snow_style;
  if (has_snow()) {
    light = with_snow(light);
  }
#endif
  color = encoded(light);
#endif
#endif
}
