// GLSL only: the work group's number in a dispatch of the blocks [first_block, end_block), or of ends, in rows.
uniform int first_block;
uniform int end_block;
/// The slot of objects[0].
uniform int first_slot;

int group_number() { return first_block + int(gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x); }

/// Place on its map of a block's cell; `block`: a ReposeBlock.
ivec3 map_place(uvec4 block, int cell) {
  return ivec3(int(block.x) + (cell & (kReposeBlock - 1)), int(block.y) + (cell >> kReposeBlockBits), int(block.z));
}
