// Sets the snow of all blocks' cells at the beginning of a step. One work group per block.
#include "lib/repose_shared.h"
#include "lib/texel_repose.h"

layout(local_size_x = 64) in;
#include "glsl/repose_number.glsl"
layout(r32f) readonly uniform image2DArray height_map;
/// See repose_surface.
uniform samplerBuffer points;
uniform samplerBuffer slopes;
/// Per cell: number of the texel's links, at least kLinks, << 4, and its links to the forward neighbours.
uniform usamplerBuffer cell_links;
/// A ReposeBlock each.
uniform usamplerBuffer blocks;
layout(std430) readonly buffer Objects { ReposeObject objects[]; };
/// See repose_rounds.
layout(std430) writeonly buffer Cells { vec4 cells[]; };

void main() {
  const int block = group_number();
  if (block >= end_block) {
    return;
  }
  const uvec4 at = texelFetch(blocks, block);
  const float unit = objects[int(at.w) - first_slot].anchor.w;
  for (int i = int(gl_LocalInvocationID.x); i < kReposeCells; i += 64) {
    const int cell = block * kReposeCells + i;
    const vec4 point = texelFetch(points, cell);
    vec4 own = vec4(0.0, 0.0, 0.0, kUnbounded);
    if (point.w > 0.0) {
      const vec4 slope = texelFetch(slopes, cell);
      const float height = imageLoad(height_map, map_place(at, i)).x;
      const float side = snow_side(height, slope.y, slope.w > 0.0);
      own.x = point.z;
      own.z = abs(height) * (point.w / unit);
      if (!is_wall(side * slope.y)) {
        own.y = column_height(side * slope.x) * (unit / point.w);
        own.w = kRate * kLinks / (own.y * float(texelFetch(cell_links, cell).x >> 4));
      }
    }
    cells[cell] = own;
  }
}
