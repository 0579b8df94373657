// GLSL only: rounds of flows along the links of a window. Requests and movements are sums of integers, so that the order
// of the invocations does not matter. Include it after the shader's local_size_x.
#include "repose_window.glsl"

/// Per cell: height of the bare surface, rise per unit, units at the step's beginning, ease of flow (link_rate is the
/// minimum of two cells' eases).
uniform samplerBuffer cells;
/// Per cell: limits of the links to its forward neighbours.
uniform samplerBuffer limits;
/// Number of the sweep's first round since the step began.
uniform int first_round;

/// Height of the surface, units that have come, and flows along forward links.
shared float top[kReposeWindowCells];
shared int moved[kReposeWindowCells];
shared int flows[4 * kReposeWindowCells];
/// Units requested from a cell; between share_out and give, the bits of the fraction that it gives.
shared int requests[kReposeWindowCells];
/// Per round: whether snow flows along links of a row of the window, and of any row. In most blocks it flows in a few.
shared uint row_flows[kReposeRounds * kReposeWindow];
shared uint has_flow[kReposeRounds];

float top_of(vec4 cell, int units) { return cell.x + cell.y * (cell.z + float(units)); }
float gives_of(vec4 cell, int units) { return cell.y > 0.0 ? max(cell.z + float(units), 0.0) : 0.0; }

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
        // NVIDIA's compiler fails at a choice within the index.
        const int giver = next > 0 ? i : to;
        atomicAdd(requests[giver], abs(next));
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
