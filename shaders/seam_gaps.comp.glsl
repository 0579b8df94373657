// Seam levelling (native/snow/level_seams.h), the points: by how much the two sides of a seam differ.
//
// MARK: which points need the fine rounds. SPREAD: a point that shares a texel with one is marked too.
layout(local_size_x = 64) in;
#include "item_index.h"
layout(std430) readonly buffer RowBegin { int row_begin[]; };
layout(std430) readonly buffer RowSource { int row_source[]; };
/// What the map holds a texel: heights, or with SPREAD marks.
layout(std430) readonly buffer Heights { float heights[]; };
#ifndef SPREAD
layout(std430) readonly buffer RowWeight { float row_weight[]; };
#endif
#if defined(MARK) || defined(SPREAD)
layout(std430) writeonly buffer Marks { float marks[]; };
#else
/// How much of each point's difference counts, 0 to 1.
layout(std430) readonly buffer Marks { float marks[]; };
layout(std430) writeonly buffer Gaps { float gaps[]; };
#endif
#ifdef MARK
uniform float level_within;
uniform float least_height;
#endif
uniform int count;

void main() {
  const int point = item_index();
  if (point >= count) {
    return;
  }
  float half_gap = 0.0;
  float height = 0.0;
  for (int i = row_begin[point]; i < row_begin[point + 1]; ++i) {
#ifdef SPREAD
    height = max(height, heights[row_source[i]]);
#else
    const float part = row_weight[i] * heights[row_source[i]];
    half_gap += part;
    height += abs(part);
#endif
  }
#if defined(SPREAD)
  marks[point] = height;
#elif defined(MARK)
  const float allowed = level_within * max(height, least_height);
  marks[point] = clamp(2.0 * abs(half_gap) / allowed - 1.0, 0.0, 1.0);
#else
  gaps[point] = marks[point] == 0.0 ? 0.0 : marks[point] * half_gap;
#endif
}
