// First of the deposit's three parts: every texel that takes part in the pixel above it adds its
// projected area to that pixel's sum, in integers, so that the order does not matter.
#include "fall_frame.h"

layout(local_size_x = 64) in;
layout(std430) readonly buffer Triangles { SceneTriangle triangles[]; };
layout(std430) readonly buffer TriangleSurface { vec4 triangle_surface[]; };
layout(std430) readonly buffer Texels { Texel texels[]; };
layout(std430) readonly buffer TexelSurface { vec4 texel_surface[]; };
layout(std430) writeonly buffer TexelTargets { TexelTarget targets[]; };
uniform usampler2D occlusion;
layout(r32ui) uniform uimage2D weight_sum;
uniform ivec2 tile_origin;
uniform ivec2 tile_size;

void main() {
  const uint index = gl_GlobalInvocationID.x;
  const Texel texel = texels[index];
  targets[index] = TexelTarget(0u, 0u);
  if (texel.place == kNowhere) {
    return;
  }
  const vec4 surface = texel_surface[index];
  const vec3 projected = project(surface.xyz);
  const ivec2 pixel = ivec2(floor(projected.xy)) - tile_origin;
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, tile_size))) {
    return;
  }
  const uvec2 seen = texelFetch(occlusion, pixel, 0).xy;
  if (seen.x == 0u || (seen.x & kBackFace) != 0u) {
    return;
  }
  const uint seen_triangle = seen.x - 1u;
  if (triangles[seen_triangle].object != triangles[texel.triangle].object) {
    return;
  }
  const float facing = -dot(triangle_surface[texel.triangle].xyz, fall.direction.xyz);
  const float pixel_size = fall.direction.w;
  const float weight = surface.w * facing / (pixel_size * pixel_size) * float(kPixelWeight);
  // A texel of hundreds of pixels is met by the pixels' centres as well as can be.
  if (facing <= 0.0 || weight < 0.5 || weight >= 256.0 * float(kPixelWeight)) {
    return;
  }
  // The shallower of the two surfaces: a wall's own slope would let it reach far below an edge.
  const float seen_facing = -dot(triangle_surface[seen_triangle].xyz, fall.direction.xyz);
  const float tolerance = 1.5 * pixel_size / max(facing, seen_facing);
  if (abs(projected.z - uintBitsToFloat(seen.y)) > tolerance) {
    return;
  }
  const uint rounded = uint(weight + 0.5);
  targets[index] = TexelTarget(uint(pixel.y * tile_size.x + pixel.x) + 1u, rounded);
  imageAtomicAdd(weight_sum, pixel, rounded);
}
