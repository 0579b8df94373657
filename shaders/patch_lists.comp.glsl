// Writes the lists of plain and tessellated patches, in patch order on every GPU.
#include "lib/tree_shared.h"

layout(local_size_x = int(kPatchGroup)) in;
layout(std430) readonly buffer PatchClasses { uint patch_classes[]; };
/// Begin of the work group's patches in either list.
layout(std430) readonly buffer GroupCounts { uvec2 group_counts[]; };
layout(std430) writeonly buffer PlainPatches { uint plain_patches[]; };
layout(std430) writeonly buffer TessellatedPatches { uint tessellated_patches[]; };
uniform int count;

shared uint classes[kPatchGroup];

void main() {
  const int index = int(gl_GlobalInvocationID.x);
  const uint self = gl_LocalInvocationIndex;
  classes[self] = index < count ? patch_classes[index] : kDropped;
  barrier();
  if (classes[self] == kDropped) {
    return;
  }
  uint before = 0u;
  for (uint i = 0u; i < self; ++i) {
    before += classes[i] == classes[self] ? 1u : 0u;
  }
  const uvec2 begin = group_counts[gl_WorkGroupID.x];
  if (classes[self] == kPlain) {
    plain_patches[begin.x + before] = uint(index);
  } else {
    tessellated_patches[begin.y + before] = uint(index);
  }
}
