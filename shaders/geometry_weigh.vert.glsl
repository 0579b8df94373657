#version 410 core
#extension GL_ARB_shading_language_420pack : require
// GEOMETRY's first part: a point a texel, drawn on the pixel it takes its snow from.
#include "texel_target.h"

flat out float weight;

void main() {
  const TexelStep step = step_of(gl_VertexID, texel_object(gl_VertexID));
  weight = float(step.weight) / float(kPixelWeight);
  const vec2 at = vec2(unpacked_pixel(step.pixel)) + 0.5;
  // Outside the clip volume where the texel takes no part.
  gl_Position = step.weight == 0u ? vec4(2.0, 2.0, 2.0, 1.0)
                                   : vec4(at / vec2(tile_size) * 2.0 - 1.0, 0.0, 1.0);
  gl_PointSize = 1.0;
}
