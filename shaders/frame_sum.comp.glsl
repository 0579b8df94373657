// Adds a picture's light to the sum of a frame's samples.

layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler2D light;
layout(rgba32f) uniform image2D sum;
/// Of this sample.
uniform float weight;

/// Limit for light of single pixels, which averaging would not smooth.
const float kMaxLight = 1000.0;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, imageSize(sum)))) {
    return;
  }
  const vec4 added = min(texelFetch(light, at, 0), vec4(kMaxLight));
  imageStore(sum, at, imageLoad(sum, at) + weight * added);
}
