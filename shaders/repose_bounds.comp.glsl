// Bounds the snow above the outlets of a surface (rims and walls over which snow falls): see lower_tile_bounds in
// native/snow/repose/tile.h. A work group lowers the bounds of a block's window and writes the block.
// LOCAL_SIZE: work-group size; see native/snow/step/gl/repose.cpp.
#include "glsl/repose_window.glsl"

layout(local_size_x = LOCAL_SIZE) in;
#include "glsl/repose_activate.glsl"
// As in repose_rounds.
uniform samplerBuffer cells;
uniform samplerBuffer limits;
uniform usamplerBuffer first_end;
uniform usamplerBuffer ends;
uniform samplerBuffer end_limits;
/// Per cell: the maximum height of the snow's surface, before and after this sweep.
uniform samplerBuffer bounds_before;
layout(std430) writeonly buffer Bounds { float bounds_after[]; };

/// Fraction of a bound's rise over a quad below which a change is not passed on.
const float kWorth = 4e-3;
/// Fraction of the product of two sides below which a triangle is degenerate, seen from above.
const float kFlat = 1e-4;

shared float bounds[kReposeWindowCells];
/// The bound that a cell passes on to its neighbours.
shared float passed[kReposeWindowCells];
shared float lengths[4 * kReposeWindowCells];
/// Per iteration: whether bounds of a row of the window have been lowered, and of any row. 0: before the first.
shared uint row_changes[(kReposeBoundIterations + 1) * kReposeWindow];
shared uint changes[kReposeBoundIterations + 1];
/// Whether the block's bounds differ from those before; and whether by more than its outlets, which all windows know.
shared uint has_changed;
shared uint has_news;

float passed_on(int cell, float bound) {
  const vec4 own = texelFetch(cells, cell);
  return passed_bound(bound, own.x + own.y * own.z, own.x);
}

/// The bound of a cell from its own outlets and across seams.
float bound_from_ends(int cell, float bound, float bare) {
  float least = bound;
  for (int i = int(texelFetch(first_end, cell).x); i >= 0; ++i) {
    const uvec4 end = texelFetch(ends, 2 * i);
    if (int(end.x) != cell) {
      break;
    }
    const vec4 limit = texelFetch(end_limits, i);
    if (limit.w == kEndAtOutlet) {
      least = min(least, limit.x + kCuts * limit.y);
    } else if (limit.w == kEndAtSeam) {
      const float over = passed_on(int(end.y), texelFetch(bounds_before, int(end.y)).x) + kCuts * limit.y;
      least = min(least, max(over, bare));
    }
  }
  return least;
}

void load(int block) {
  for (int i = int(gl_LocalInvocationID.x); i < kReposeWindowCells; i += LOCAL_SIZE) {
    const int cell = window_cell(block, i);
    float bound = kUnbounded;
    vec4 limit = vec4(kNoLink);
    if (cell >= 0) {
      const vec4 own = texelFetch(cells, cell);
      bound = texelFetch(bounds_before, cell).x;
      limit = texelFetch(limits, cell);
      // A wall is an outlet.
      bound = own.w == kUnbounded ? min(bound, own.x) : bound_from_ends(cell, bound, own.x);
    }
    bounds[i] = bound;
    passed[i] = kUnbounded;
    if (bound < kUnbounded) {
      row_changes[i / kReposeWindow] = 1u;
    }
    for (int k = 0; k < 4; ++k) {
      lengths[k * kReposeWindowCells + i] = has_forward(i, k) && limit[k] < kNoLink ? kCuts * limit[k] : kNoLink;
    }
  }
}

bool changed_in_row(int iteration, int row) {
  return row >= 0 && row < kReposeWindow && row_changes[iteration * kReposeWindow + row] != 0u;
}

// In the functions below rare work is a loop that runs once, which software renderers skip (CONTRIBUTING.md).

void pass_on(int block, int iteration) {
  for (int row = first_in_window().y; row < kReposeWindow; row += kWindowStep.y) {
    for (bool rare = changed_in_row(iteration, row); rare; rare = false) {
      for (int column = first_in_window().x; column < kReposeWindow; column += kWindowStep.x) {
        const int i = row * kReposeWindow + column;
        const int cell = window_cell(block, i);
        passed[i] = cell < 0 || bounds[i] == kUnbounded ? kUnbounded : passed_on(cell, bounds[i]);
      }
    }
  }
}

/// Length of the link between two neighbours of the window, `way` apart, in metres of bound.
float length_between(int a, ivec2 way) {
  const bool forward = way.y > 0 || (way.y == 0 && way.x > 0);
  const ivec2 step = forward ? way : -way;
  const int first = forward ? a : a + way.y * kReposeWindow + way.x;
  const int k = step.y == 0 ? 0 : step.x == 0 ? 1 : step.x > 0 ? 2 : 3;
  return lengths[k * kReposeWindowCells + first];
}

/// The bound of a corner of a triangle by the paths that cross the opposite side, along which bounds are linear, from
/// `a` to `b`: along the path with the smallest rise, if it crosses the side (Hopf and Lax's formula on a triangle: F.
/// Bornemann and C. Rasch, Finite-element discretization of static Hamilton-Jacobi equations based on a local
/// variational principle, 2006). `way_a`, `way_b`, `side`: lengths of the sides. y: distance of the side.
vec2 over_side(float a, float b, float way_a, float way_b, float side) {
  const float rise = b - a;
  if (!(abs(rise) < side)) {
    return vec2(kUnbounded, 0.0);
  }
  // From the foot of the corner on the side to the side's beginning.
  const float place = (way_b * way_b - way_a * way_a - side * side) / (2.0 * side);
  const float square = way_a * way_a - place * place;
  if (!(square * side * side > kFlat * way_a * way_a * side * side)) {
    return vec2(kUnbounded, 0.0);
  }
  const float away = sqrt(square);
  const float part = rise / side;
  const float flatness = sqrt(1.0 - part * part);
  const float foot = -part * away;
  const bool crosses = foot >= place * flatness && foot <= (place + side) * flatness;
  return vec2(crosses ? a + (away * flatness - part * place) : kUnbounded, away);
}

/// The bound of a cell from its neighbours.
float lowered(int i, float bound, float bare) {
  const ivec2 at = place_in_window(i) + kReposeBorder;
  float least = bound;
  // Around the cell, straight neighbours at even numbers.
  const ivec2 ways[9] = ivec2[9](ivec2(1, 0), ivec2(1, 1), ivec2(0, 1), ivec2(-1, 1), ivec2(-1, 0), ivec2(-1, -1),
                                 ivec2(0, -1), ivec2(1, -1), ivec2(1, 0));
  float before = kUnbounded;
  float way_before = kNoLink;
  for (int n = 0; n < 9; ++n) {
    const ivec2 way = ways[n];
    const ivec2 to = at + way;
    const bool is_inside = to.x >= 0 && to.x < kReposeWindow && to.y >= 0 && to.y < kReposeWindow;
    const float own_length = is_inside ? length_between(i, way) : kNoLink;
    const float own = own_length < kNoLink ? passed[to.y * kReposeWindow + to.x] : kUnbounded;
    if (own < kUnbounded) {
      least = min(least, max(own + own_length, bare));
    }
    if (own < kUnbounded && before < kUnbounded) {
      const ivec2 back = ways[max(n - 1, 0)];
      const float side = length_between((at.y + back.y) * kReposeWindow + at.x + back.x, way - back);
      const vec2 over = side < kNoLink ? over_side(before, own, way_before, own_length, side) : vec2(kUnbounded, 0.0);
      const float now = max(over.x, bare);
      least = now < least - kWorth * over.y ? now : least;
    }
    before = own;
    way_before = own_length;
  }
  return least;
}

void lower(int block, int iteration) {
  for (int row = first_in_window().y; row < kReposeWindow; row += kWindowStep.y) {
    bool rare = changed_in_row(iteration, row - 1) || changed_in_row(iteration, row) ||
                changed_in_row(iteration, row + 1);
    for (; rare; rare = false) {
      for (int column = first_in_window().x; column < kReposeWindow; column += kWindowStep.x) {
        const int i = row * kReposeWindow + column;
        const int cell = window_cell(block, i);
        const float own = bounds[i];
        const float now = cell < 0 ? own : lowered(i, own, texelFetch(cells, cell).x);
        if (now < own) {
          bounds[i] = now;
          row_changes[(iteration + 1) * kReposeWindow + row] = changes[iteration + 1] = 1u;
          if (is_in_block(i)) {
            has_news = 1u;
          }
        }
      }
    }
  }
}

void main() {
  const int block = listed_block();
  if (block < 0) {
    return;
  }
  if (gl_LocalInvocationID.x == 0u) {
    touch(block);
    has_changed = has_news = 0u;
  }
  for (int i = int(gl_LocalInvocationID.x); i < (kReposeBoundIterations + 1) * kReposeWindow; i += LOCAL_SIZE) {
    row_changes[i] = changes[i % (kReposeBoundIterations + 1)] = 0u;
  }
  barrier();
  load(block);
  for (int i = 0; i < kReposeBoundIterations; ++i) {
    barrier();
    pass_on(block, i);
    barrier();
    lower(block, i);
    barrier();
    if (changes[i + 1] == 0u) {
      break;
    }
  }
  barrier();
  for (int i = int(gl_LocalInvocationID.x); i < kReposeCells; i += LOCAL_SIZE) {
    const int cell = block * kReposeCells + i;
    const float now = bounds[(i / kReposeBlock + kReposeBorder) * kReposeWindow + i % kReposeBlock + kReposeBorder];
    bounds_after[cell] = now;
    if (now != texelFetch(bounds_before, cell).x) {
      has_changed = 1u;
    }
  }
  barrier();
  if (has_news != 0u) {
    activate_near(block);
  } else if (has_changed != 0u && gl_LocalInvocationID.x == 0u) {
    activate(uint(block));
  }
}
