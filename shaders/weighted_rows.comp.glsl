// Weighted sums: ghosts beyond a seam, the map's continuation beyond its charts, seam levelling.
layout(local_size_x = 64) in;
layout(std430) readonly buffer RowBegin { int row_begin[]; };
layout(std430) readonly buffer RowSource { int row_source[]; };
layout(std430) readonly buffer RowWeight { float row_weight[]; };
layout(std430) readonly buffer RowTarget { int row_target[]; };
/// May be the same buffer: rows never write what others read.
layout(std430) readonly buffer SourceValues { float source_values[]; };
layout(std430) buffer TargetValues { float target_values[]; };
uniform int count;
/// 0: the sum replaces the target; 1: a row without terms leaves kNothing there; 2: the sum is added,
/// and the target stays 0 or more.
uniform int mode;

const int kReplaceOrNothing = 1;
const int kAdd = 2;
const float kNothing = -1.0;

void main() {
  const int row = int(gl_GlobalInvocationID.x);
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
  if (mode == kAdd) {
    target_values[target] = max(0.0, target_values[target] + sum);
  } else {
    target_values[target] = mode == kReplaceOrNothing && begin == end ? kNothing : sum;
  }
}
