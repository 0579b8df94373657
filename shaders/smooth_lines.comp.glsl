// One pass of the thesis's Gaussian along the lines of an axis, across seams through their ghosts: five bilinear taps
// over nine texels. Bare texels stay bare and are excluded from their neighbours' means, so that snow keeps its edges.
// Source: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, section 4.2.1.
layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
layout(std430) readonly buffer Texels { int texels[]; };
layout(std430) readonly buffer Place { int place[]; };
layout(std430) readonly buffer Line { float line[]; };
layout(std430) writeonly buffer Map { float map[]; };
uniform int count;

const int kReach = 4;
/// Weights of the middle, and of the bilinear taps at 1.3846 and 3.2307 texels, split between their two texels.
const float kWeights[kReach + 1] = float[kReach + 1](0.2270270270, 0.1945945946, 0.1216216216, 0.0540540541, 0.0162162162);

/// Ghosts without surface hold -1e30 (kNothing in native/snow/seams/seam_table.h). The two sides are not mixed.
bool is_snow(float height, float here) {
  return height * here > 0.0 && height > -1e29;
}

void main() {
  const int index = item_index();
  if (index >= count) {
    return;
  }
  const int at = place[index];
  const float here = line[at];
  float sum = kWeights[0] * here;
  float weight = kWeights[0];
  // Snow beyond a bare texel is not connected.
  for (int side = -1; side <= 1; side += 2) {
    for (int k = 1; k <= kReach && is_snow(line[at + side * k], here); ++k) {
      sum += kWeights[k] * line[at + side * k];
      weight += kWeights[k];
    }
  }
  map[texels[index]] = here == 0.0 ? 0.0 : sum / weight;
}
