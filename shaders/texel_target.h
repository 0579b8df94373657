// GLSL only: which pixel a texel takes its snow from. Both formulations of the deposit include it.
#include "fall_frame.h"

// Buffer textures instead of storage blocks: llvmpipe reads a whole vector at once from them, and
// OpenGL 4.1 has no storage blocks.
uniform usamplerBuffer texels;
uniform samplerBuffer texel_surface;
uniform samplerBuffer triangle_surface;
/// Per work group of texels: its object's slot.
uniform usamplerBuffer group_slots;
uniform usampler2D occlusion;
uniform ivec2 tile_origin;
uniform ivec2 tile_size;

/// The pixel that the texel's sample point projects to, if it takes part there: the pixel shows its
/// map, it faces the fall, and the depths agree.
TexelTarget target_of(int index) {
  const TexelTarget none = TexelTarget(0u, 0u);
  const vec4 surface = texelFetch(texel_surface, index);
  const vec3 projected = project(surface.xyz);
  const ivec2 pixel = ivec2(floor(projected.xy)) - tile_origin;
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, tile_size))) {
    return none;
  }
  const uvec4 seen = texelFetch(occlusion, pixel, 0);
  const uint slot = texelFetch(group_slots, index / int(kTexelGroup)).x | kReceives;
  if (seen.x == 0u || (seen.x & kBackFace) != 0u || seen.z != slot) {
    return none;
  }
  const uint triangle = texelFetch(texels, index).x;
  const float facing = -dot(texelFetch(triangle_surface, int(triangle)).xyz, fall.direction.xyz);
  const float pixel_size = fall.direction.w;
  const float weight = surface.w * facing / (pixel_size * pixel_size) * float(kPixelWeight);
  // A texel of hundreds of pixels is met by the pixels' centres as well as can be.
  if (facing <= 0.0 || weight < 0.5 || weight >= 256.0 * float(kPixelWeight)) {
    return none;
  }
  // The shallower of the two surfaces: a wall's own slope would let it reach far below an edge.
  const float tolerance = 1.5 * pixel_size / max(facing, uintBitsToFloat(seen.w));
  if (abs(projected.z - uintBitsToFloat(seen.y)) > tolerance) {
    return none;
  }
  return TexelTarget(uint(pixel.y * tile_size.x + pixel.x) + 1u, uint(weight + 0.5));
}
