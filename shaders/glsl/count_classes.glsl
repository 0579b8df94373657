// The main of a pass that sorts patches into classes and counts the drawn ones per work group. `class_of` is
// defined by the pass.
#include "glsl/work_range.glsl"

layout(std430) writeonly buffer PatchClasses { uint patch_classes[]; };
/// Plain and tessellated patches of a work group.
layout(std430) writeonly buffer GroupCounts { uvec2 group_counts[]; };
/// Number of work groups; those of the last row may be more.
uniform int groups;

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

/// Class of an item of a range.
uint class_of(WorkRange range, int item);

void main() {
  if (gl_LocalInvocationIndex == 0u) {
    plain_count = 0u;
    tessellated_count = 0u;
  }
  barrier();
  const WorkRange range = work_range();
  const int item = work_slot() - range.first_slot;
  if (item < range.count) {
    const uint found = class_of(range, range.first_item + item);
    patch_classes[work_slot()] = found;
    if (found == kPlain) {
      atomicAdd(plain_count, 1u);
    } else if (found == kTessellated) {
      atomicAdd(tessellated_count, 1u);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && work_group() < groups) {
    group_counts[work_group()] = uvec2(plain_count, tessellated_count);
  }
}
