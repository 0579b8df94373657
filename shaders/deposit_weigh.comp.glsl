// First of the deposit's parts, see texel_weigh.h.
#include "texel_group.h"
#include "texel_weigh.h"

layout(local_size_x = 64) in;

void main() {
  const int index = listed_texel();
  weigh_texel(index, texel_object(index));
}
