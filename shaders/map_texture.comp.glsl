// Copies a map from a buffer to the texture that is drawn.
layout(local_size_x = 16, local_size_y = 16) in;
layout(std430) readonly buffer Map { float map[]; };
layout(r32f) writeonly uniform image2D height_map;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 size = imageSize(height_map);
  if (all(lessThan(at, size))) {
    imageStore(height_map, at, vec4(map[at.y * size.x + at.x]));
  }
}
