// Seam levelling (native/snow/level_seams.h), the texels: each takes its share of the differences at
// the points around it and goes on in the direction of the round before.
//
// SPREAD: a texel is marked when one of its points is.
layout(local_size_x = 64) in;
#include "item_index.h"
layout(std430) readonly buffer RowBegin { int row_begin[]; };
layout(std430) readonly buffer RowSource { int row_source[]; };
layout(std430) readonly buffer RowTarget { int row_target[]; };
/// What each point holds: half a difference, or with SPREAD its mark.
layout(std430) readonly buffer Points { float points[]; };
/// What the points look at.
layout(std430) buffer Ahead { float ahead[]; };
#ifndef SPREAD
layout(std430) readonly buffer RowWeight { float row_weight[]; };
layout(std430) buffer Map { float map[]; };
/// Per row: where the first round left the texel; fine rounds stay within most_change of it.
layout(std430) buffer Start { float start[]; };
uniform float momentum;
uniform int fine;
uniform float most_change;
uniform float least_height;
#endif
uniform int count;

void main() {
  const int row = item_index();
  if (row >= count) {
    return;
  }
  float sum = 0.0;
  for (int i = row_begin[row]; i < row_begin[row + 1]; ++i) {
#ifdef SPREAD
    sum = max(sum, points[row_source[i]]);
#else
    sum += row_weight[i] * points[row_source[i]];
#endif
  }
  const int texel = row_target[row];
#ifdef SPREAD
  ahead[texel] = sum;
#else
  float next = max(0.0, ahead[texel] + sum);
  if (fine == 0) {
    start[row] = next;
  } else {
    const float reach = most_change * (start[row] + least_height);
    next = clamp(next, max(0.0, start[row] - reach), start[row] + reach);
  }
  ahead[texel] = max(0.0, next + momentum * (next - map[texel]));
  map[texel] = next;
#endif
}
