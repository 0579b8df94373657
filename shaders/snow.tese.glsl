// Puts the tessellator's vertices onto a receiver's snow.
#include "glsl/snow_surface.glsl"
// What both hold is included once, where no switch leaves it out.
#include "glsl/snow_outputs.glsl"

layout(triangles, fractional_odd_spacing, ccw) in;
patch in uint patch_index;

void main() {
  const int index = int(patch_index);
  hand_on(index, gl_TessCoord, patch_surface(index, gl_TessCoord));
}
