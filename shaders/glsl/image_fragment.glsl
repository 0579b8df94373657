// A pixel of what shows an image: holes where that is less than half there; how the rest is lit is `lit_image`, which
// the shader that includes this defines.
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
/// Linear; times that of the image.
uniform vec4 image_color;
in vec3 world;

/// Light of a pixel whose colour is this.
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
