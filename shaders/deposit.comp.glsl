// The deposit of one tile, see texel_gain.h.
#include "lib/texel_gain.h"
#include "glsl/texel_group.glsl"

layout(local_size_x = 64) in;
/// Per work group of texels: its object's slot.
uniform usamplerBuffer group_slots;
/// By slot: what to add to a scene triangle's index to get its index among the map triangles.
uniform isamplerBuffer map_offsets;

void main() {
  const int slot = int(texelFetch(group_slots, listed_group()).x);
  gather_texel(listed_texel(), texelFetch(map_offsets, slot).x);
}
