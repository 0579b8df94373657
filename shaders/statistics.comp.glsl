// Sums, in a fixed order and in double precision, the results of the stability pass's invocations for one object. One
// work group per segment.
// LOCAL_SIZE: work-group size of that pass; see native/snow/step/gl/driver.h.
#include "lib/snow_shared.h"

layout(local_size_x = 64) in;
layout(std430) readonly buffer Partials { vec4 partials[]; };
layout(std430) readonly buffer Segments { StatisticsSegment segments[]; };
layout(std430) buffer Sums { ObjectSums sums[]; };

shared dvec4 lanes[gl_WorkGroupSize.x];

void main() {
  const StatisticsSegment segment = segments[gl_WorkGroupID.x];
  dvec4 sum = dvec4(0.0);
  for (uint i = gl_LocalInvocationID.x; i < segment.group_count * LOCAL_SIZE;
       i += gl_WorkGroupSize.x) {
    sum += dvec4(partials[segment.first_group * LOCAL_SIZE + i]);
  }
  lanes[gl_LocalInvocationID.x] = sum;
  barrier();
  if (gl_LocalInvocationID.x == 0u) {
    for (uint i = 1u; i < gl_WorkGroupSize.x; ++i) {
      sum += lanes[i];
    }
    sums[segment.slot].deposited += sum.x;
    sums[segment.slot].slid += sum.y;
    sums[segment.slot].held += sum.z;
    sums[segment.slot].visible_area += sum.w;
  }
}
