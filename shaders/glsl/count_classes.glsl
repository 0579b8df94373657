// The main of a pass that sorts patches into classes and counts the drawn ones per work group. Include it after `uint
// class_of(int index)`.
#include "lib/tree_shared.h"

layout(local_size_x = int(kPatchGroup)) in;
layout(std430) writeonly buffer PatchClasses { uint patch_classes[]; };
/// Plain and tessellated patches of a work group.
layout(std430) writeonly buffer GroupCounts { uvec2 group_counts[]; };
uniform int count;

shared uint plain_count;
shared uint tessellated_count;

/// True if a sphere is outside the picture.
bool is_outside(vec3 centre, float radius) {
  for (int k = 0; k < 6; ++k) {
    if (dot(view.planes[k], vec4(centre, 1.0)) < -radius) {
      return true;
    }
  }
  return false;
}

uint class_of(int index);

void main() {
  if (gl_LocalInvocationIndex == 0u) {
    plain_count = 0u;
    tessellated_count = 0u;
  }
  barrier();
  const int index = int(gl_GlobalInvocationID.x);
  if (index < count) {
    const uint found = class_of(index);
    patch_classes[index] = found;
    if (found == kPlain) {
      atomicAdd(plain_count, 1u);
    } else if (found == kTessellated) {
      atomicAdd(tessellated_count, 1u);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u) {
    group_counts[gl_WorkGroupID.x] = uvec2(plain_count, tessellated_count);
  }
}
