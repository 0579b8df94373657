// Lists the blocks in which snow is too steep, and those around them. One work group per block.
#include "glsl/repose_around.glsl"
#include "glsl/repose_append.glsl"

layout(local_size_x = 64) in;
#include "glsl/repose_number.glsl"
// See repose_rounds.
uniform samplerBuffer cells;
uniform samplerBuffer limits;
uniform usamplerBuffer first_end;
uniform usamplerBuffer ends;
uniform samplerBuffer end_limits;
/// The list of the first sweep of rounds.
uniform int rounds_begin;
uniform int rounds_head;

shared uint is_steep;
shared uint has_snow_on_walls;

bool exceeds(vec4 a, vec4 b, float limit) {
  const float fall = a.x + a.y * a.z - (b.x + b.y * b.z);
  const vec4 giver = fall < 0.0 ? b : a;
  return abs(fall) > limit && giver.y * giver.z > 0.0 && giver.z >= 1.0;
}

bool any_end_exceeds(int cell, vec4 own) {
  bool any = false;
  for (int i = int(texelFetch(first_end, cell).x); i >= 0; ++i) {
    const uvec4 end = texelFetch(ends, 2 * i);
    if (int(end.x) != cell) {
      break;
    }
    const vec4 limit = texelFetch(end_limits, i);
    if (limit.w == kEndAtSeam) {
      any = any || exceeds(own, texelFetch(cells, int(end.y)), limit.y);
    } else if (limit.w == kEndAtOutlet) {
      any = any || (own.x + own.y * own.z - limit.x > limit.y && own.z >= 1.0);
    }
  }
  return any;
}

void main() {
  const int block = group_number();
  if (block >= end_block) {
    return;
  }
  if (gl_LocalInvocationID.x == 0u) {
    is_steep = has_snow_on_walls = 0u;
  }
  barrier();
  bool steep = false;
  bool on_walls = false;
  for (int i = int(gl_LocalInvocationID.x); i < kReposeCells; i += 64) {
    const int cell = block * kReposeCells + i;
    const vec4 own = texelFetch(cells, cell);
    const vec4 limit = texelFetch(limits, cell);
    on_walls = on_walls || (own.y == 0.0 && own.z > 0.0);
    for (int k = 0; k < 4; ++k) {
      if (limit[k] < kNoLink) {
        const int to = cell_at(block, ivec2(i & (kReposeBlock - 1), i >> kReposeBlockBits) + forward_step(k));
        steep = steep || exceeds(own, texelFetch(cells, to), limit[k]);
      }
    }
    steep = steep || any_end_exceeds(cell, own);
  }
  if (steep) {
    is_steep = 1u;
  }
  if (on_walls) {
    has_snow_on_walls = 1u;
  }
  barrier();
  if (has_snow_on_walls != 0u && gl_LocalInvocationID.x == 0u) {
    touch(block);
  }
  if (is_steep != 0u) {
    const int end = int(texelFetch(near_begin, block + 1).x);
    for (int i = int(texelFetch(near_begin, block).x + gl_LocalInvocationID.x); i < end; i += 64) {
      const uint other = texelFetch(near, i).x;
      if (atomicExchange(block_states[other].listed, sweep) != sweep) {
        append(other, next_begin, head);
        append(other, rounds_begin, rounds_head);
        block_states[other].listed_first = step_number;
      }
    }
  }
}
