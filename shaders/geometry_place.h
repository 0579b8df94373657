// GLSL only: what the vertex shaders of GEOMETRY hand to the geometry shader.
flat out float thickness;
/// Place on the layered map; z = -1 where there is nothing to deposit.
flat out ivec3 map_place;
