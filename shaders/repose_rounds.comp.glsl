// Moves snow along the links of the listed blocks for kReposeRounds rounds, after one round across seams and over rims:
// see lib/texel_repose.h. A work group moves the snow of a block's window and writes the block. All read the maps of the
// sweep before, so the order of the work groups does not matter. Flows are whole units, and both work groups that see a
// link compute it from the same numbers, so what leaves a cell arrives at its neighbour.
// LOCAL_SIZE: work-group size; see native/snow/step/gl/repose.cpp.
#include "glsl/repose_window.glsl"

layout(local_size_x = LOCAL_SIZE) in;
#include "glsl/repose_activate.glsl"
/// Per cell: height of the bare surface, rise per unit, units at the step's beginning, ease of flow (link_rate is the
/// minimum of two cells' eases).
uniform samplerBuffer cells;
/// Per cell: limits of the links to its forward neighbours.
uniform samplerBuffer limits;
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
/// Number of the sweep's first round since the step began, and of the sweep.
uniform int first_round;
uniform int round_across;

/// Height of the surface, units that have come, and flows along forward links.
shared float top[kReposeWindowCells];
shared int moved[kReposeWindowCells];
shared int flows[4 * kReposeWindowCells];
/// Units that are requested of a cell; from share_out to give, the bits of the part of them that it gives.
shared int requests[kReposeWindowCells];
/// Per round: whether snow flows along links of a row of the window, and of any row. In most blocks it flows in a few.
shared uint row_flows[kReposeRounds * kReposeWindow];
shared uint has_flow[kReposeRounds];
/// Whether the block is not yet at rest.
shared uint has_changed;

float top_of(vec4 cell, int units) { return cell.x + cell.y * (cell.z + float(units)); }
float gives_of(vec4 cell, int units) { return cell.y > 0.0 ? max(cell.z + float(units), 0.0) : 0.0; }

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

bool flows_in_row(int round_of_sweep, int row) {
  return row >= 0 && row < kReposeWindow && row_flows[round_of_sweep * kReposeWindow + row] != 0u;
}
/// Whether snow flows along links of the cells of a row, in this row or from the one before.
bool flows_at_row(int round_of_sweep, int row) {
  return flows_in_row(round_of_sweep, row) || flows_in_row(round_of_sweep, row - 1);
}

// In the functions below rare work is a loop that runs once, which software renderers skip (CONTRIBUTING.md). Rows that
// are no longer correct in a round are left out.

bool may_flow(int round_of_sweep, int row) {
  const int before = round_of_sweep - 1;
  return row >= 2 * round_of_sweep && row < kReposeWindow - 2 * round_of_sweep &&
         (before < 0 || flows_at_row(before, row) || flows_in_row(before, row + 1));
}

void request_from(int block, int i, int round_of_sweep, float momentum) {
  const int cell = window_cell(block, i);
  const vec4 limit = cell < 0 ? vec4(kNoLink) : texelFetch(limits, cell);
  vec4 flow = vec4(0.0);
  vec4 fall = vec4(0.0);
  const float own_top = top[i];
  for (int k = 0; k < 4; ++k) {
    flow[k] = float(flows[k * kReposeWindowCells + i]);
    fall[k] = limit[k] < kNoLink && has_forward(i, k) ? own_top - top[i + forward_in_window(k)] : 0.0;
  }
  bool flows_now = any(notEqual(flow, vec4(0.0))) || any(greaterThan(abs(fall), limit));
  for (; flows_now; flows_now = false) {
    const float own_ease = texelFetch(cells, cell).w;
    for (int k = 0; k < 4; ++k) {
      const int to = i + forward_in_window(k);
      int next = 0;
      if (fall[k] != 0.0) {
        const float ease = min(own_ease, texelFetch(cells, window_cell(block, to)).w);
        next = int(wanted_flow(flow[k], fall[k], limit[k], ease, momentum));
      }
      flows[k * kReposeWindowCells + i] = next;
      if (next != 0) {
        atomicAdd(requests[next > 0 ? i : to], abs(next));
        row_flows[round_of_sweep * kReposeWindow + i / kReposeWindow] = has_flow[round_of_sweep] = 1u;
      }
    }
  }
}

void request(int block, int round_of_sweep) {
  const float momentum = flow_momentum(first_round + round_of_sweep);
  for (int row = first_in_window().y; row < kReposeWindow; row += kWindowStep.y) {
    bool rare = may_flow(round_of_sweep, row);
    for (; rare; rare = false) {
      for (int column = first_in_window().x; column < kReposeWindow; column += kWindowStep.x) {
        request_from(block, row * kReposeWindow + column, round_of_sweep, momentum);
      }
    }
  }
}

void share_out(int block, int round_of_sweep) {
  for (int row = first_in_window().y; row < kReposeWindow; row += kWindowStep.y) {
    for (bool rare = flows_at_row(round_of_sweep, row); rare; rare = false) {
      for (int column = first_in_window().x; column < kReposeWindow; column += kWindowStep.x) {
        const int i = row * kReposeWindow + column;
        for (int wanted = requests[i]; wanted > 0; wanted = 0) {
          const float gives = gives_of(texelFetch(cells, window_cell(block, i)), moved[i]);
          requests[i] = floatBitsToInt(given_part(gives, float(wanted)));
        }
      }
    }
  }
}

void give_along(int i, int k) {
  const int wanted = flows[k * kReposeWindowCells + i];
  for (bool flows_now = wanted != 0; flows_now; flows_now = false) {
    const int to = i + forward_in_window(k);
    const float part = intBitsToFloat(requests[wanted > 0 ? i : to]);
    const int flow = int(given_flow(float(wanted), part, part));
    flows[k * kReposeWindowCells + i] = flow;
    atomicAdd(moved[i], -flow);
    atomicAdd(moved[to], flow);
  }
}

void give(int round_of_sweep) {
  for (int row = first_in_window().y; row < kReposeWindow; row += kWindowStep.y) {
    for (bool rare = flows_in_row(round_of_sweep, row); rare; rare = false) {
      for (int column = first_in_window().x; column < kReposeWindow; column += kWindowStep.x) {
        for (int k = 0; k < 4; ++k) {
          give_along(row * kReposeWindow + column, k);
        }
      }
    }
  }
}

void receive(int block, int round_of_sweep) {
  for (int row = first_in_window().y; row < kReposeWindow; row += kWindowStep.y) {
    for (bool rare = flows_at_row(round_of_sweep, row); rare; rare = false) {
      for (int column = first_in_window().x; column < kReposeWindow; column += kWindowStep.x) {
        const int i = row * kReposeWindow + column;
        const int cell = window_cell(block, i);
        requests[i] = 0;
        top[i] = cell < 0 ? 0.0 : top_of(texelFetch(cells, cell), moved[i]);
      }
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
