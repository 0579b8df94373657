// GLSL only: lists the blocks of the next sweep.

/// A block whose data is not yet the same before and after a sweep.
void activate(uint block) {
  if (atomicExchange(block_states[block].listed, sweep + 1u) != sweep + 1u) {
    append(block, next_begin, head + 1);
  }
}

/// The blocks that a changed block affects, itself included.
void activate_near(int block) {
  const int end = int(texelFetch(near_begin, block + 1).x);
  for (int i = int(texelFetch(near_begin, block).x + gl_LocalInvocationID.x); i < end; i += int(gl_WorkGroupSize.x)) {
    activate(texelFetch(near, i).x);
  }
}
