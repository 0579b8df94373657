// A pixel of a leaf: lit from both sides, partly translucent.
#include "glsl/image_fragment.glsl"
#ifndef SHADOW
#ifndef WIRE
in vec3 card_normal;
/// Fraction of the light that a leaf transmits.
const float kThrough = 0.4;

vec3 lit_image(vec3 albedo) {
  vec3 normal = normalize(card_normal);
  if (dot(normal, view.eye.xyz - world) < 0.0) {
    normal = -normal;
  }
  return lit(albedo, world, normal, normal, kThrough);
}
#endif
#endif
