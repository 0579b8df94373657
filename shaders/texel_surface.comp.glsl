// Area and upward part of texels on the current vertices, in steps whose deposit does not find them.
#include "texel_group.h"
#include "texel_parts.h"

layout(local_size_x = 64) in;
layout(std430) writeonly buffer TexelSteps { TexelStep texel_steps[]; };

void main() {
  const int index = listed_texel();
  const TexelParts parts = parts_of(index);
  texel_steps[index] = TexelStep(0u, 0u, parts.area, parts.up);
}
