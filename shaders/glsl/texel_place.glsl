// GLSL only: the position of a texel on the maps of its group.

/// Column, row and layer of a texel's `place` on maps of `resolution`. It divides as floats, because software renderers
/// divide integers one lane at a time. The row may be off by one, which shows in the column.
ivec3 decoded_place(uint place, int resolution, float one_over_resolution) {
  int row = int(float(place) * one_over_resolution);
  int column = int(place) - row * resolution;
  const int off = column < 0 ? -1 : column >= resolution ? 1 : 0;
  row += off;
  column -= off * resolution;
  const int layer = int((float(row) + 0.5) * one_over_resolution);
  return ivec3(column, row - layer * resolution, layer);
}
