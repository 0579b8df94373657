// Passes a listed patch to the tessellator: its single control point is its instance and its number;
// their records hold the rest.

layout(std430) readonly buffer TessellatedPatches { ivec2 tessellated_patches[]; };
out ivec2 listed_patch;

void main() {
  listed_patch = tessellated_patches[gl_VertexID];
  gl_Position = vec4(0.0);
}
