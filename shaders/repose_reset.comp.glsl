// Clears the movement of this step's blocks, in both copies.
#include "glsl/repose_list.glsl"

layout(local_size_x = 64) in;
layout(std430) writeonly buffer Moved { int moved[]; };
layout(std430) writeonly buffer OtherMoved { int other_moved[]; };
layout(std430) writeonly buffer Flows { vec4 flows[]; };
layout(std430) writeonly buffer OtherFlows { vec4 other_flows[]; };
layout(std430) writeonly buffer Bounds { float bounds[]; };
layout(std430) writeonly buffer OtherBounds { float other_bounds[]; };

void main() {
  const int block = listed_block();
  for (int i = int(gl_LocalInvocationID.x); block >= 0 && i < kReposeCells; i += 64) {
    const int cell = block * kReposeCells + i;
    moved[cell] = 0;
    other_moved[cell] = 0;
    flows[cell] = vec4(0.0);
    other_flows[cell] = vec4(0.0);
    bounds[cell] = kUnbounded;
    other_bounds[cell] = kUnbounded;
  }
}
