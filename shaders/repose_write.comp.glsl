// Writes the snow that has moved in this step's blocks, and prepares them for the next step. Snow that sticks to walls
// falls, except a fraction.
// LOCAL_SIZE: work-group size; see native/snow/step/gl/repose.cpp.
#include "glsl/repose_list.glsl"

layout(local_size_x = LOCAL_SIZE) in;
#include "glsl/repose_number.glsl"
layout(r32f) uniform image2DArray height_map;
uniform samplerBuffer points;
uniform samplerBuffer slopes;
uniform samplerBuffer cells;
/// A ReposeBlock each.
uniform usamplerBuffer blocks;
uniform isamplerBuffer moved_last;
layout(std430) readonly buffer Objects { ReposeObject objects[]; };
/// Per block: volume in m3 that left the surface.
layout(std430) writeonly buffer Lost { double lost[]; };
/// The fraction of the snow on walls that stays.
uniform float walls_keep;

shared double lanes[LOCAL_SIZE];

/// Thickness of the snow of a wall after the step.
float kept_on_wall(float depth) {
  const float left = depth * walls_keep;
  return left < kWallLeast ? 0.0 : left;
}

/// Writes a cell; returns the volume that left it.
double write_cell(int cell, ivec3 at, float unit) {
  const vec4 point = texelFetch(points, cell);
  if (!(point.w > 0.0)) {
    return double(0.0);
  }
  const vec4 slope = texelFetch(slopes, cell);
  const float height = imageLoad(height_map, at).x;
  const float side = snow_side(height, slope.y, slope.w > 0.0);
  if (texelFetch(cells, cell).y == 0.0) {
    const float kept = kept_on_wall(abs(height));
    if (height != 0.0) {
      imageStore(height_map, at, vec4(kept > 0.0 ? side * kept : 0.0));
    }
    return double(abs(height) - kept) * double(point.w);
  }
  const int moved = texelFetch(moved_last, cell).x;
  if (moved != 0) {
    const double depth = double(abs(height)) + double(moved) * (double(unit) / double(point.w));
    const float now = float(max(depth, double(0.0)));
    imageStore(height_map, at, vec4(now > 0.0 ? side * now : 0.0));
  }
  return -double(moved) * double(unit);
}

void main() {
  const int block = listed_block();
  if (block < first_block || block >= end_block) {
    return;
  }
  const uvec4 place = texelFetch(blocks, block);
  const float unit = objects[int(place.w) - first_slot].anchor.w;
  double sum = double(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < kReposeCells; i += LOCAL_SIZE) {
    sum += write_cell(block * kReposeCells + i, map_place(place, i), unit);
  }
  lanes[gl_LocalInvocationID.x] = sum;
  barrier();
  if (gl_LocalInvocationID.x == 0u) {
    for (int i = 1; i < LOCAL_SIZE; ++i) {
      sum += lanes[i];
    }
    lost[block] = sum;
  }
}
