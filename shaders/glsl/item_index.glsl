#pragma once

// GLSL only: the item of an invocation of Program::dispatch_items. Groups are laid out in two dimensions if one
// dimension is too small. Include it after the shader's local_size_x.
int item_index() {
  return int(gl_GlobalInvocationID.x +
             gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * gl_WorkGroupSize.x));
}
