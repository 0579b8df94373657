// Positions of the work groups' plain and tessellated patches in the lists, and the batches' draws, in one work group.
#include "lib/tree_shared.h"

layout(local_size_x = 64) in;
/// Replaced by the sums over earlier work groups, and at the end over all.
layout(std430) buffer GroupCounts { uvec2 group_counts[]; };
layout(std430) readonly buffer DrawBatches { DrawBatch batches[]; };
/// A draw of each batch's plain patches (`plain_vertices` each), then draws of the batches' tessellated ones (one
/// control point each).
layout(std430) writeonly buffer DrawCommands { TreeDrawCommand commands[]; };
uniform int count;
uniform int batch_count;
uniform int plain_vertices;
uniform int patches_a_draw;

shared uvec2 sums[64];

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
    group_counts[count] = before;
  }
  memoryBarrierBuffer();
  barrier();
  for (int b = 0; b < batch_count; ++b) {
    const DrawBatch batch = batches[b];
    const ivec2 from = ivec2(group_counts[batch.first_group]);
    const ivec2 to = ivec2(group_counts[batch.end_group]);
    if (self == 0) {
      commands[b] = TreeDrawCommand(uint(plain_vertices * (to.x - from.x)), 1u, uint(plain_vertices * from.x), 0u);
    }
    for (int i = self; i < batch.draws; i += 64) {
      const int first = from.y + i * patches_a_draw;
      const int left = clamp(to.y - first, 0, patches_a_draw);
      commands[batch.first_draw + i] = TreeDrawCommand(uint(left), 1u, uint(first), 0u);
    }
  }
}
