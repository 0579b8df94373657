// One pass of the separable 5-tap Gaussian along u, along v, or (a closing pass) by the mean of both:
// D. T. Reynolds, Real-Time Rendering and Simulation of Trees and Snow, 2014, section 4.2. The line
// arrays continue across seams by themselves; what holds kNothing takes no part.
layout(local_size_x = 64) in;
#include "glsl/item_index.glsl"
/// 256 x 5: weights of a texel and of its first to fourth neighbours on either side.
layout(std430) readonly buffer LevelWeights { float level_weights[]; };
/// Level along u in the lowest byte, along v in the next.
layout(std430) readonly buffer Levels { uint levels[]; };
layout(std430) readonly buffer Texels { int texels[]; };
layout(std430) readonly buffer PlaceU { int place_u[]; };
layout(std430) readonly buffer PlaceV { int place_v[]; };
layout(std430) readonly buffer LineU { float line_u[]; };
layout(std430) readonly buffer LineV { float line_v[]; };
layout(std430) writeonly buffer NextU { float next_u[]; };
layout(std430) writeonly buffer NextV { float next_v[]; };
layout(std430) writeonly buffer Map { float map[]; };
uniform int count;
uniform int axes;
uniform int last;

const int kAlongU = 1;
const int kAlongV = 2;
const int kReach = 4;
/// See kNothing in native/snow/seams/seam_table.h.
const float kSomething = -1e29;

float along_u(int place, int weights) {
  const float own = level_weights[weights];
  float sum = own * line_u[place];
  float present = own;
  for (int k = 1; k <= kReach; ++k) {
    const float weight = level_weights[weights + k];
    const float before = line_u[place - k];
    const float after = line_u[place + k];
    const float weight_before = before > kSomething ? weight : 0.0;
    const float weight_after = after > kSomething ? weight : 0.0;
    sum += weight_before * before;
    sum += weight_after * after;
    present += weight_before;
    present += weight_after;
  }
  return sum / present;
}

float along_v(int place, int weights) {
  const float own = level_weights[weights];
  float sum = own * line_v[place];
  float present = own;
  for (int k = 1; k <= kReach; ++k) {
    const float weight = level_weights[weights + k];
    const float before = line_v[place - k];
    const float after = line_v[place + k];
    const float weight_before = before > kSomething ? weight : 0.0;
    const float weight_after = after > kSomething ? weight : 0.0;
    sum += weight_before * before;
    sum += weight_after * after;
    present += weight_before;
    present += weight_after;
  }
  return sum / present;
}

void main() {
  const int index = item_index();
  if (index >= count) {
    return;
  }
  const uint level = levels[index];
  const int weights_u = int(level & 255u) * (kReach + 1);
  const int weights_v = int(level >> 8) * (kReach + 1);
  float height = 0.0;
  if (axes == kAlongU) {
    height = along_u(place_u[index], weights_u);
  } else if (axes == kAlongV) {
    height = along_v(place_v[index], weights_v);
  } else {
    height = 0.5 * (along_u(place_u[index], weights_u) + along_v(place_v[index], weights_v));
  }
  if (last != 0) {
    map[texels[index]] = height;
  } else {
    next_u[place_u[index]] = height;
    next_v[place_v[index]] = height;
  }
}
