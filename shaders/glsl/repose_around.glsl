// GLSL only: cells around a block, for the repose passes.
#include "../lib/repose_shared.h"
#include "../lib/texel_repose.h"

/// The nine blocks around every block, row by row, kNowhere if there is none.
uniform usamplerBuffer around;

/// A limit that no difference of heights exceeds: there is no link.
const float kNoLink = kUnbounded;

/// The cell at a place counted from a block's first cell, up to a block away; -1: none.
int cell_at(int block, ivec2 at) {
  const ivec2 step = at + kReposeBlock;
  const int number = (step.y >> kReposeBlockBits) * 3 + (step.x >> kReposeBlockBits);
  const int own = int(texelFetch(around, 9 * block + number).x);
  const ivec2 inside = at & (kReposeBlock - 1);
  return own < 0 ? -1 : own * kReposeCells + inside.y * kReposeBlock + inside.x;
}

/// The neighbour to which link k (0 to 3) of a cell leads, see kForwardColumn in native/snow/repose/links.h.
ivec2 forward_step(int k) { return ivec2(k == 1 ? 0 : k == 3 ? -1 : 1, k == 0 ? 0 : 1); }
