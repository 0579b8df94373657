// Removes the snow above the bounds of this step's blocks.
#include "glsl/repose_append.glsl"

layout(local_size_x = 64) in;
uniform samplerBuffer cells;
uniform samplerBuffer bounds;
/// Both copies, see repose_rounds.
layout(std430) writeonly buffer Moved { int moved[]; };
layout(std430) writeonly buffer OtherMoved { int other_moved[]; };
uniform int rounds_begin;
uniform int rounds_head;

shared uint cuts;

/// Units to remove from a cell. A sliver of a texel may hold less than one.
int units_over(vec4 cell, float bound) {
  const float top = cell.x + cell.y * cell.z;
  if (!(bound < top) || !(cell.y * cell.z > 0.0)) {
    return 0;
  }
  return int(floor(min((top - max(bound, cell.x)) / cell.y, cell.z)));
}

void main() {
  const int block = listed_block();
  if (block < 0) {
    return;
  }
  if (gl_LocalInvocationID.x == 0u) {
    cuts = 0u;
  }
  barrier();
  for (int i = int(gl_LocalInvocationID.x); i < kReposeCells; i += 64) {
    const int cell = block * kReposeCells + i;
    const int units = units_over(texelFetch(cells, cell), texelFetch(bounds, cell).x);
    if (units > 0) {
      moved[cell] = -units;
      other_moved[cell] = -units;
      cuts = 1u;
    }
  }
  barrier();
  if (cuts != 0u) {
    const int end = int(texelFetch(near_begin, block + 1).x);
    for (int i = int(texelFetch(near_begin, block).x + gl_LocalInvocationID.x); i < end; i += 64) {
      const uint other = texelFetch(near, i).x;
      if (atomicExchange(block_states[other].listed_first, step_number) != step_number) {
        append(other, rounds_begin, rounds_head);
      }
    }
  }
}
