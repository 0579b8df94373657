// GLSL only: a texel's place on its group's maps.

/// Column, row and layer of a texel's `place` on maps of `resolution`. Divides in floats, since software renderers
/// divide integers lane by lane: a row is off by at most one, which the column reveals.
ivec3 decoded_place(uint place, int resolution, float one_over_resolution) {
  int row = int(float(place) * one_over_resolution);
  int column = int(place) - row * resolution;
  const int off = column < 0 ? -1 : column >= resolution ? 1 : 0;
  row += off;
  column -= off * resolution;
  const int layer = int((float(row) + 0.5) * one_over_resolution);
  return ivec3(column, row - layer * resolution, layer);
}
