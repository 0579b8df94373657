// The range of a work group's items. Groups are laid out in two dimensions if one dimension is too small.
#pragma once
#include "lib/tree_shared.h"

layout(local_size_x = int(kPatchGroup)) in;
layout(std430) readonly buffer WorkRanges { WorkRange ranges[]; };
uniform int range_count;

int work_group() { return int(gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x); }

/// Number of this invocation among the slots of all ranges.
int work_slot() { return work_group() * int(kPatchGroup) + int(gl_LocalInvocationIndex); }

/// The range of this work group. Past the last item it returns the last range.
WorkRange work_range() {
  const int slot = work_group() * int(kPatchGroup);
  int low = 0;
  int end = range_count;
  while (end - low > 1) {
    const int middle = (low + end) / 2;
    if (ranges[middle].first_slot <= slot) {
      low = middle;
    } else {
      end = middle;
    }
  }
  return ranges[low];
}
