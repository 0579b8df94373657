// Writes the lists of plain and tessellated items, each an instance and an item, in their order on every GPU.
#include "glsl/work_range.glsl"

layout(std430) readonly buffer PatchClasses { uint patch_classes[]; };
/// Begin of the work group's patches in either list.
layout(std430) readonly buffer GroupCounts { uvec2 group_counts[]; };
layout(std430) writeonly buffer PlainPatches { ivec2 plain_patches[]; };
layout(std430) writeonly buffer TessellatedPatches { ivec2 tessellated_patches[]; };

shared uint classes[kPatchGroup];

void main() {
  const WorkRange range = work_range();
  const int item = work_slot() - range.first_slot;
  const uint self = gl_LocalInvocationIndex;
  classes[self] = item < range.count ? patch_classes[work_slot()] : kDropped;
  barrier();
  if (classes[self] == kDropped) {
    return;
  }
  uint before = 0u;
  for (uint i = 0u; i < self; ++i) {
    before += classes[i] == classes[self] ? 1u : 0u;
  }
  const uvec2 begin = group_counts[work_group()];
  if (classes[self] == kPlain) {
    plain_patches[begin.x + before] = ivec2(range.instance, range.first_item + item);
  } else {
    tessellated_patches[begin.y + before] = ivec2(range.instance, range.first_item + item);
  }
}
