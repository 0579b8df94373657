// Adds the snow that fell off a receiver to its balance: in a fixed order, in double precision. One work group per
// receiver.
#include "lib/repose_shared.h"

layout(local_size_x = 64) in;
/// Slot of the first receiver in these passes.
uniform int first_slot;
/// First block of every receiver, and the number of blocks.
layout(std430) readonly buffer FirstBlocks { uint first_blocks[]; };
layout(std430) buffer Lost { double lost[]; };
layout(std430) buffer Sums { ObjectSums sums[]; };

shared double lanes[gl_WorkGroupSize.x];

void main() {
  const uint receiver = gl_WorkGroupID.x;
  double sum = double(0.0);
  for (uint i = first_blocks[receiver] + gl_LocalInvocationID.x; i < first_blocks[receiver + 1u]; i += 64u) {
    sum += lost[i];
    lost[i] = double(0.0);
  }
  lanes[gl_LocalInvocationID.x] = sum;
  barrier();
  if (gl_LocalInvocationID.x == 0u) {
    for (uint i = 1u; i < 64u; ++i) {
      sum += lanes[i];
    }
    sums[first_slot + int(receiver)].slid += sum;
    sums[first_slot + int(receiver)].held -= sum;
  }
}
