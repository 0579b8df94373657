// The instances of trees in a frame.
#pragma once
#include "lib/tree_shared.h"

layout(std430) readonly buffer TreeInstances { TreeInstance instances[]; };
/// The instance of this invocation, set by main.
TreeInstance tree;

bool has_snow() { return tree.map.x > 0; }

/// Moves the rows of a bone's matrix to the instance's place in the world.
void rows_to_world(inout vec4 row_x, inout vec4 row_y, inout vec4 row_z) {
  const vec4 x = row_x;
  const vec4 y = row_y;
  const vec4 z = row_z;
  row_x = tree.to_world[0].x * x + tree.to_world[0].y * y + tree.to_world[0].z * z + vec4(0.0, 0.0, 0.0, tree.to_world[0].w);
  row_y = tree.to_world[1].x * x + tree.to_world[1].y * y + tree.to_world[1].z * z + vec4(0.0, 0.0, 0.0, tree.to_world[1].w);
  row_z = tree.to_world[2].x * x + tree.to_world[2].y * y + tree.to_world[2].z * z + vec4(0.0, 0.0, 0.0, tree.to_world[2].w);
}
