// A pixel with an image. It is a hole if the image's alpha is below one half. The including shader defines its lighting
// in `lit_image`.
//
// SHADOW: depth alone. WIRE: one colour, unlit.
uniform sampler2D image;
in vec2 image_uv;
#ifndef SHADOW
layout(location = 0) out vec4 color;
#ifdef WIRE
uniform vec4 wire_color;
#else
#include "glsl/lighting.glsl"
/// Linear colour, multiplied by the image's.
uniform vec4 image_color;
in vec3 world;

/// Light of a pixel with this colour.
vec3 lit_image(vec3 albedo);
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
  color = encoded(lit_image(texel.rgb * image_color.rgb));
#endif
#endif
}
