// GLSL only: adds blocks to lists, for the repose passes.
#include "repose_list.glsl"

layout(std430) buffer BlockStates { ReposeBlockState block_states[]; };
layout(std430) buffer Lists { uint new_lists[]; };
/// Blocks that see a block's cells in their windows, or those linked with them across seams: [near_begin[b],
/// near_begin[b + 1]) of near.
uniform usamplerBuffer near_begin;
uniform usamplerBuffer near;
/// Number of this sweep and of this step, ascending.
uniform uint sweep;
uniform uint step_number;
/// The list of the next sweep; and the list, with its header, of all blocks of this step.
uniform int next_begin;
uniform int touched_begin;
uniform int touched_head;

void append(uint block, int begin, int list) {
  const uint item = atomicAdd(heads[list].count, 1u);
  if (item % kReposeListRows == 0u) {
    atomicAdd(heads[list].groups_x, 1u);
  }
  new_lists[begin + int(item)] = block;
}

/// Notes that the block takes part in this step.
void touch(int block) {
  if (atomicExchange(block_states[block].touched, step_number) != step_number) {
    append(uint(block), touched_begin, touched_head);
  }
}
