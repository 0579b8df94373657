// A pixel of a leaf: holes where its image is less than half there, lit from both sides, some light through it.
//
// SHADOW: depth alone. WIRE: one colour.
uniform sampler2D image;
in vec2 image_uv;
#ifndef SHADOW
layout(location = 0) out vec4 color;
#ifdef WIRE
uniform vec4 wire_color;
#else
#include "glsl/lighting.glsl"
/// Linear; times that of the image.
uniform vec4 leaf_color;
in vec3 world;
in vec3 card_normal;
/// Share of the light that comes through a leaf.
const float kThrough = 0.4;
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
  vec3 normal = normalize(card_normal);
  if (dot(normal, view.eye.xyz - world) < 0.0) {
    normal = -normal;
  }
  color = encoded(lit(texel.rgb * leaf_color.rgb, world, normal, normal, kThrough));
#endif
#endif
}
