// Counts, per receiver, the pixels in which the sky sees back faces of surfaces that gather nothing: a hint at flipped
// normals.
// LOCAL_SIZE: invocations of a work group; see native/snow/step/gl/driver.h.
#include "lib/tile_pixel.h"
#include "glsl/triangle_object.glsl"

layout(local_size_x = LOCAL_SIZE) in;
/// By slot.
layout(std430) buffer BackPixels { uint back_pixels[]; };
/// A SeenPixel each.
uniform usamplerBuffer occlusion;

void add(uint slot, uint count) {
  if (count > 0u) {
    atomicAdd(back_pixels[slot], count);
  }
}

void main() {
  // A work group processes a run of a row, each invocation every LOCAL_SIZE-th pixel of it.
  const int y = int(gl_WorkGroupID.y) + kTileMargin;
  const int begin = int(gl_WorkGroupID.x * kRowRun + gl_LocalInvocationID.x) + kTileMargin;
  const int end = min(int((gl_WorkGroupID.x + 1u) * kRowRun), tile_size.x - 2 * kTileMargin) + kTileMargin;
  uint current = 0u;
  uint count = 0u;
  for (int x = begin; x < end; x += LOCAL_SIZE) {
    const uint seen = texelFetch(occlusion, pixel_index(ivec2(x, y))).x;
    const uint object = (seen & kBackFace) == 0u ? 0u : object_of((seen & ~kBackFace) - 1u);
    if ((object & (kReceives | kTwoSided)) != kReceives) {
      continue;
    }
    const uint slot = object & kSlotBits;
    if (slot != current) {
      add(current, count);
      current = slot;
      count = 0u;
    }
    ++count;
  }
  add(current, count);
}
