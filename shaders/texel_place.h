// GLSL only: where a texel lies on its group's maps.

/// Column, row and layer of a texel's `place` on maps of `resolution`.
ivec3 decoded_place(uint place, int resolution) {
  const uint in_map = place % uint(resolution * resolution);
  return ivec3(in_map % uint(resolution), in_map / uint(resolution),
               place / uint(resolution * resolution));
}
