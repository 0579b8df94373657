// Sorts patches into dropped (outside of the picture, of a level that is too far away, or below some pixels), plain
// (all edges at level 1) and tessellated, and counts the latter two for each work group.
#include "glsl/tree_view.glsl"
#include "lib/tessellation.h"

layout(local_size_x = int(kPatchGroup)) in;
layout(std430) readonly buffer PosedVertices { PosedVertex posed[]; };
layout(std430) readonly buffer TreePatches { TreePatch patches[]; };
layout(std430) readonly buffer EdgeLevels { float edge_levels[]; };
layout(std430) writeonly buffer PatchClasses { uint patch_classes[]; };
/// Plain and tessellated patches of a work group.
layout(std430) writeonly buffer GroupCounts { uvec2 group_counts[]; };
uniform int count;

shared uint plain_count;
shared uint tessellated_count;

uint patch_class(TreePatch of) {
  const PosedVertex corners[4] =
      PosedVertex[4](posed[of.vertices.x], posed[of.vertices.y], posed[of.vertices.z], posed[of.vertices.w]);
  const vec3 centre =
      0.25 * (corners[0].position.xyz + corners[1].position.xyz + corners[2].position.xyz + corners[3].position.xyz);
  float radius = 0.0;
  float stretch = 0.0;
  for (int k = 0; k < 4; ++k) {
    radius = max(radius, distance(centre, corners[k].position.xyz));
    stretch = max(stretch, max(length(corners[k].row_x.xyz),
                               max(length(corners[k].row_y.xyz), length(corners[k].row_z.xyz))));
  }
  radius += of.rest[1].w * stretch;
  for (int k = 0; k < 6; ++k) {
    if (dot(view.planes[k], vec4(centre, 1.0)) < -radius) {
      return kDropped;
    }
  }
  const float away = distance(view.eye.xyz, centre);
  if (2.0 * radius * view.eye.w < view.tessellation.w * away) {
    return kDropped;
  }
  if (view.thesis.w > 0.5 && is_level_too_far(away, float(of.place.y), view.thesis)) {
    return kDropped;
  }
  const float highest = max(max(edge_levels[of.edges.x >> 1], edge_levels[of.edges.y >> 1]),
                            max(edge_levels[of.edges.z >> 1], edge_levels[of.edges.w >> 1]));
  return highest > 1.0 ? kTessellated : kPlain;
}

void main() {
  if (gl_LocalInvocationIndex == 0u) {
    plain_count = 0u;
    tessellated_count = 0u;
  }
  barrier();
  const int index = int(gl_GlobalInvocationID.x);
  if (index < count) {
    const uint class_of = patch_class(patches[index]);
    patch_classes[index] = class_of;
    if (class_of == kPlain) {
      atomicAdd(plain_count, 1u);
    } else if (class_of == kTessellated) {
      atomicAdd(tessellated_count, 1u);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u) {
    group_counts[gl_WorkGroupID.x] = uvec2(plain_count, tessellated_count);
  }
}
