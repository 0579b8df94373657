// GLSL only: what the vertex shaders of GEOMETRY hand to the geometry shader.
flat out float thickness;
/// Place on the layered map; z = -1 where there is nothing to deposit.
flat out ivec3 map_place;

/// Column, row and layer of a texel's `place` on maps of `resolution`.
ivec3 decoded_place(uint place, int resolution) {
  const uint in_map = place % uint(resolution * resolution);
  return ivec3(in_map % uint(resolution), in_map / uint(resolution),
               place / uint(resolution * resolution));
}
