// Area and upward parts of texels on the current vertices, in steps without a deposit pass.
#include "glsl/texel_fragments.glsl"
#include "glsl/texel_group.glsl"

layout(local_size_x = 64) in;
/// A TexelStep each, as one vector.
layout(std430) writeonly buffer TexelSteps { uvec4 texel_steps[]; };

void main() {
  const int index = listed_texel();
  const TexelSurface surface =
      sum_of_fragments(int(texelFetch(fragment_begin, index).x), int(texelFetch(fragment_begin, index + 1).x))
          .surface;
  texel_steps[index] = uvec4(0u, floatBitsToUint(surface.area), floatBitsToUint(surface.up),
                             floatBitsToUint(surface.back_up));
}
