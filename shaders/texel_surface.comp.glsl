// Area and upward part of texels on the current vertices, in steps whose deposit does not find them.
#include "texel_group.h"
#include "texel_parts.h"

layout(local_size_x = 64) in;
/// A TexelStep each, as one vector: llvmpipe stores it in one go.
layout(std430) writeonly buffer TexelSteps { uvec4 texel_steps[]; };

void main() {
  const int index = listed_texel();
  const TexelParts parts = parts_of(index);
  texel_steps[index] = uvec4(0u, 0u, floatBitsToUint(parts.area), floatBitsToUint(parts.up));
}
