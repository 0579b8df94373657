// Positions of the work groups' plain and tessellated patches in the lists, and the lists' draws, in one work group.
#include "lib/tree_shared.h"

layout(local_size_x = 64) in;
/// Replaced by the sums over earlier work groups.
layout(std430) buffer GroupCounts { uvec2 group_counts[]; };
/// Draws of the plain patches (`plain_vertices` each), then of the tessellated ones (one control point each) in `draws`
/// parts.
layout(std430) writeonly buffer DrawCommands { TreeDrawCommand commands[]; };
uniform int count;
uniform int draws;
uniform int plain_vertices;
uniform int patches_a_draw;

shared uvec2 sums[64];
shared uvec2 total;

void main() {
  const int each = (count + 63) / 64;
  const int self = int(gl_LocalInvocationIndex);
  const int begin = min(self * each, count);
  const int end = min(begin + each, count);
  uvec2 sum = uvec2(0u);
  for (int i = begin; i < end; ++i) {
    sum += group_counts[i];
  }
  sums[self] = sum;
  barrier();
  uvec2 before = uvec2(0u);
  for (int i = 0; i < self; ++i) {
    before += sums[i];
  }
  for (int i = begin; i < end; ++i) {
    const uvec2 here = group_counts[i];
    group_counts[i] = before;
    before += here;
  }
  if (self == 63) {
    total = before;
  }
  barrier();
  if (self == 0) {
    commands[0] = TreeDrawCommand(uint(plain_vertices) * total.x, 1u, 0u, 0u);
  }
  for (int i = self; i < draws; i += 64) {
    const int first = i * patches_a_draw;
    const int left = clamp(int(total.y) - first, 0, patches_a_draw);
    commands[1 + i] = TreeDrawCommand(uint(left), 1u, uint(first), 0u);
  }
}
