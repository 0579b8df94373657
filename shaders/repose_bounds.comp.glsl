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

#include "glsl/repose_paths.glsl"

shared float bounds[kReposeWindowCells];
/// Per iteration: whether bounds of a row of the window have been lowered, and of any row. 0: before the first.
shared uint row_changes[(kReposeBoundIterations + 1) * kReposeWindow];
shared uint changes[kReposeBoundIterations + 1];
/// Whether the sweep lowered the block's bounds; and whether by more than its outlets, which all windows include.
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
