// Moves snow along the links of the listed blocks for kReposeRounds rounds, after one round across seams and over rims:
// see lib/texel_repose.h. A work group moves the snow of a block's window and writes the block. All read the maps of the
// sweep before, so the order of the work groups does not matter. Flows are whole units, and both work groups that see a
// link compute it from the same numbers, so what leaves a cell arrives at its neighbour.
// LOCAL_SIZE: work-group size; see native/snow/step/gl/repose.cpp.
#include "glsl/repose_window.glsl"

layout(local_size_x = LOCAL_SIZE) in;
#include "glsl/repose_activate.glsl"
/// Per cell: number of its first end, or kNowhere. The ends of a cell follow each other.
uniform usamplerBuffer first_end;
/// A ReposeEnd each, as two vectors.
uniform usamplerBuffer ends;
/// Per end: height of the rim or wall (unused for seams), limit, rate, kind.
uniform samplerBuffer end_limits;
/// Before this sweep: units that have come since the step began, flows per link and end.
uniform isamplerBuffer moved_before;
uniform samplerBuffer flows_before;
uniform samplerBuffer end_flows_before;
layout(std430) writeonly buffer Moved { int moved_after[]; };
layout(std430) writeonly buffer Flows { vec4 flows_after[]; };
layout(std430) writeonly buffer EndFlows { float end_flows_after[]; };
/// Number of the sweep.
uniform int round_across;

#include "glsl/repose_flows.glsl"
/// Whether the block is not yet at rest.
shared uint has_changed;

/// Units that leave a cell across seams and over rims in this sweep.
int leaves_over_ends(int cell, vec4 own, int units, bool writes) {
  int sum = 0;
  const float momentum = flow_momentum(round_across);
  for (int i = int(texelFetch(first_end, cell).x); i >= 0; ++i) {
    const uvec4 end = texelFetch(ends, 2 * i);
    if (int(end.x) != cell) {
      break;
    }
    const vec4 limit = texelFetch(end_limits, i);
    float flow = 0.0;
    if (limit.w > 0.0) {
      const float before = texelFetch(end_flows_before, i).x;
      const uvec4 rest = texelFetch(ends, 2 * i + 1);
      float other_top = limit.x;
      float other_gives = 0.0;
      if (limit.w == kEndAtSeam) {
        const vec4 other = texelFetch(cells, int(end.y));
        const int other_units = texelFetch(moved_before, int(end.y)).x;
        other_top = top_of(other, other_units);
        other_gives = gives_of(other, other_units);
      }
      const float wanted = wanted_flow(before, top_of(own, units) - other_top, limit.y, limit.z, momentum);
      const float own_part = given_part(gives_of(own, units) * uintBitsToFloat(rest.y), abs(wanted));
      const float other_part = given_part(other_gives * uintBitsToFloat(rest.z), abs(wanted));
      flow = given_flow(wanted, own_part, other_part);
      sum += int(flow);
      if (writes && (flow != 0.0 || before != 0.0)) {
        has_changed = 1u;
      }
    }
    if (writes) {
      end_flows_after[i] = flow;
    }
  }
  return sum;
}

void load(int block) {
  for (int i = int(gl_LocalInvocationID.x); i < kReposeWindowCells; i += LOCAL_SIZE) {
    const int cell = window_cell(block, i);
    vec4 own = vec4(0.0);
    vec4 flow = vec4(0.0);
    int units = 0;
    if (cell >= 0) {
      own = texelFetch(cells, cell);
      flow = texelFetch(flows_before, cell);
      units = texelFetch(moved_before, cell).x;
      units -= leaves_over_ends(cell, own, units, is_in_block(i));
    }
    moved[i] = units;
    requests[i] = 0;
    top[i] = top_of(own, units);
    for (int k = 0; k < 4; ++k) {
      flows[k * kReposeWindowCells + i] = int(flow[k]);
    }
  }
}

/// Writes the block; returns whether it is not yet at rest.
bool write(int block) {
  bool changes = false;
  for (int i = int(gl_LocalInvocationID.x); i < kReposeCells; i += LOCAL_SIZE) {
    const int cell = block * kReposeCells + i;
    const int at = (i / kReposeBlock + kReposeBorder) * kReposeWindow + i % kReposeBlock + kReposeBorder;
    const vec4 flow = vec4(flows[at], flows[kReposeWindowCells + at], flows[2 * kReposeWindowCells + at],
                           flows[3 * kReposeWindowCells + at]);
    moved_after[cell] = moved[at];
    flows_after[cell] = flow;
    changes = changes || moved[at] != texelFetch(moved_before, cell).x ||
              any(notEqual(flow, vec4(0.0))) || any(notEqual(texelFetch(flows_before, cell), vec4(0.0)));
  }
  return changes;
}

void main() {
  const int block = listed_block();
  if (block < 0) {
    return;
  }
  if (gl_LocalInvocationID.x == 0u) {
    touch(block);
    has_changed = 0u;
  }
  for (int i = int(gl_LocalInvocationID.x); i < kReposeRounds * kReposeWindow; i += LOCAL_SIZE) {
    row_flows[i] = has_flow[i % kReposeRounds] = 0u;
  }
  barrier();
  load(block);
  barrier();
  for (int i = 0; i < kReposeRounds; ++i) {
    request(block, i);
    barrier();
    if (has_flow[i] == 0u) {
      break;
    }
    share_out(block, i);
    barrier();
    give(i);
    barrier();
    receive(block, i);
    barrier();
  }
  if (write(block)) {
    has_changed = 1u;
  }
  barrier();
  if (has_changed != 0u) {
    activate_near(block);
  }
}
