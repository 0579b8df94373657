#pragma once

// GLSL only: which item an invocation of Program::dispatch_items works on. Groups are laid out in two
// dimensions where one holds too few of them. Included behind the shader's local_size_x.
int item_index() {
  return int(gl_GlobalInvocationID.x +
             gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * gl_WorkGroupSize.x));
}
