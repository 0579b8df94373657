// Weighted sums: ghosts beyond a seam, the map's extension beyond its charts.
layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(std430) readonly buffer RowBegin { int row_begin[]; };
layout(std430) readonly buffer RowSource { int row_source[]; };
layout(std430) readonly buffer RowWeight { float row_weight[]; };
layout(std430) readonly buffer RowTarget { int row_target[]; };
/// May be the same buffer: no row writes a value that another reads.
layout(std430) readonly buffer SourceValues { float source_values[]; };
layout(std430) buffer TargetValues { float target_values[]; };
uniform int count;
/// Whether a row without terms leaves kNothing at its target; else 0.
uniform int nothing_without_terms;

const float kNothing = -1e30;

void main() {
  const int row = item_index();
  if (row >= count) {
    return;
  }
  const int begin = row_begin[row];
  const int end = row_begin[row + 1];
  float sum = 0.0;
  for (int i = begin; i < end; ++i) {
    sum += row_weight[i] * source_values[row_source[i]];
  }
  const int target = row_target[row];
  target_values[target] = nothing_without_terms != 0 && begin == end ? kNothing : sum;
}
