// Passes a listed patch to the tessellator: its single control point is its number; its record holds the rest.

layout(std430) readonly buffer TessellatedPatches { uint tessellated_patches[]; };
out uint listed_patch;

void main() {
  listed_patch = tessellated_patches[gl_VertexID];
  gl_Position = vec4(0.0);
}
