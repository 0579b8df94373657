// Limits of the links of all blocks' cells to their forward neighbours. One work group per block.
#include "glsl/repose_around.glsl"

layout(local_size_x = 64) in;
#include "glsl/repose_number.glsl"
// See repose_cells.
uniform samplerBuffer points;
uniform samplerBuffer slopes;
uniform usamplerBuffer cell_links;
uniform samplerBuffer cells;
layout(std430) writeonly buffer Limits { vec4 limits[]; };
#include "glsl/repose_limit.glsl"

/// Whether snow may flow along a link. Nothing moves on walls, and snow at the foot of a wall leans against it.
bool is_open(vec4 a, vec4 b, bool a_is_wall, bool b_is_wall) {
  const bool leads_onto_wall = a_is_wall != b_is_wall && (a_is_wall ? b.z > a.z : a.z > b.z);
  return a.w > 0.0 && b.w > 0.0 && (leads_onto_wall || !(a_is_wall || b_is_wall));
}

void main() {
  const int block = group_number();
  if (block >= end_block) {
    return;
  }
  for (int i = int(gl_LocalInvocationID.x); i < kReposeCells; i += 64) {
    const int cell = block * kReposeCells + i;
    const uint links = texelFetch(cell_links, cell).x;
    const vec4 a = texelFetch(points, cell);
    const vec4 slope = texelFetch(slopes, cell);
    const bool is_wall = texelFetch(cells, cell).y == 0.0;
    vec4 limit = vec4(kNoLink);
    for (int k = 0; k < 4; ++k) {
      const int to = ((links >> k) & 1u) == 0u
                         ? -1
                         : cell_at(block, ivec2(i & (kReposeBlock - 1), i >> kReposeBlockBits) + forward_step(k));
      if (to >= 0) {
        const vec4 b = texelFetch(points, to);
        const vec4 other = texelFetch(slopes, to);
        if (is_open(a, b, is_wall, texelFetch(cells, to).y == 0.0)) {
          limit[k] = limit_between(a.xyz, b.xyz, 0.5 * (slope.z + other.z),
                                   0.5 * (bare_slope(slope.y) + bare_slope(other.y)), kLeadsDown);
        }
      }
    }
    limits[cell] = limit;
  }
}
