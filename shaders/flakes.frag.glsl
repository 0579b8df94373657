// A pixel of a falling flake: a soft disc, lit from all sides.
#include "glsl/lighting.glsl"

in vec2 on_card;
in float visible;
layout(location = 0) out vec4 color;

const vec3 kFlakeAlbedo = vec3(0.9, 0.93, 0.97);
/// Flakes tumble: mean fraction of the sun's light that reaches the eye.
const float kSunShare = 0.6;

void main() {
  const float round_part = 1.0 - smoothstep(0.3, 1.0, length(on_card));
  const vec3 light = kFlakeAlbedo * (view.sky_color.rgb + kSunShare * view.sun_color.rgb);
  color = vec4(encoded(light).rgb, visible * round_part);
}
