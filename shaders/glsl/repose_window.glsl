// GLSL only: a block with its border in shared memory. LOCAL_SIZE: work-group size, a power of two from 8 on.
#include "repose_around.glsl"
#include "repose_append.glsl"

/// A cell of the window: its place counted from the block's first cell.
ivec2 place_in_window(int i) { return ivec2(i % kReposeWindow, i / kReposeWindow) - kReposeBorder; }
int window_cell(int block, int i) { return cell_at(block, place_in_window(i)); }
bool is_in_block(int i) {
  const ivec2 at = place_in_window(i);
  return (at.x & ~(kReposeBlock - 1)) == 0 && (at.y & ~(kReposeBlock - 1)) == 0;
}
/// From a cell of the window to the neighbour of link k.
int forward_in_window(int k) { return forward_step(k).y * kReposeWindow + forward_step(k).x; }
/// An invocation's cells of the window: columns and rows from first_in_window() in steps of kWindowStep.
const int kColumns = LOCAL_SIZE < kReposeWindow ? LOCAL_SIZE : kReposeWindow;
const ivec2 kWindowStep = ivec2(kColumns, LOCAL_SIZE / kColumns);
ivec2 first_in_window() { return ivec2(gl_LocalInvocationID.x % kColumns, gl_LocalInvocationID.x / kColumns); }
/// Whether link k of a cell leads to a cell of the window.
bool has_forward(int i, int k) {
  const ivec2 to = place_in_window(i) + kReposeBorder + forward_step(k);
  return to.x >= 0 && to.x < kReposeWindow && to.y < kReposeWindow;
}
