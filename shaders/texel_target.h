// GLSL only: which pixel a texel takes its snow from. Both formulations of the deposit include it.
#include "fall_frame.h"
#include "packed_pixel.h"

// Buffer textures instead of storage blocks: llvmpipe reads a whole vector at once from them, and
// OpenGL 4.1 has no storage blocks.
uniform usamplerBuffer texels;
uniform samplerBuffer texel_surface;
uniform samplerBuffer triangle_surface;
/// As the texel surface pass reads them.
uniform usamplerBuffer fragment_begin;
uniform usamplerBuffer fragments;
/// Per work group of texels: its object's slot.
uniform usamplerBuffer group_slots;
uniform usampler2D occlusion;
uniform ivec2 tile_origin;
uniform ivec2 tile_size;

/// Faces that turn nearly edge-on have slopes too steep to reckon with.
const float kLeastFacing = 1e-4;
/// How far a texel's point may lie from what its pixel shows, in pixels over the shallower slope. Beyond
/// the two planes: what lies between them may be rougher than they are, and more so round an edge.
const float kSlack = 0.25;
const float kSlackRoundEdge = 0.5;
/// Between the two planes: a wall's own slope would let it reach far below an edge.
const float kMostBend = 1.0;

/// Depth that a plane of unit normal `normal` gains in one pixel along the grid's axes.
vec2 depth_gradient(vec3 normal, float facing) {
  return vec2(dot(normal, fall.grid_x.xyz), dot(normal, fall.grid_y.xyz)) *
         (fall.direction.w * fall.direction.w / facing);
}

/// Area perpendicular to the fall of the texel's parts that face it, in m2.
float facing_area(int index) {
  float area = 0.0;
  int i = int(texelFetch(fragment_begin, index).x);
  const int end = int(texelFetch(fragment_begin, index + 1).x);
  do {
    const uvec2 fragment = texelFetch(fragments, i).xy;
    const vec4 surface = texelFetch(triangle_surface, int(fragment.x));
    const float own = i < end ? uintBitsToFloat(fragment.y) * surface.w : 0.0;
    area += own * max(-dot(surface.xyz, fall.direction.xyz), 0.0);
  } while (++i < end);
  return area;
}

/// Whether a texel's point, `offset` pixels from the centre of a pixel, lies on what the pixel shows at
/// depth `shown_depth`: on the shown plane extended to the point, on the texel's own plane extended from
/// what is shown, or between them, where the surface bends between the centre and the point. What lies
/// below another surface with the same slopes lies below both planes.
bool is_shown(vec2 offset, float depth, vec3 normal, float facing, float shown_depth, vec3 shown_normal,
              float shown_facing) {
  const vec2 shown_gradient = depth_gradient(shown_normal, shown_facing);
  const float below = depth - shown_depth - dot(shown_gradient, offset);
  const float unit = fall.direction.w / max(facing, shown_facing);
  const bool faces = facing > 0.0;
  const vec2 gradient = depth_gradient(normal, max(facing, kLeastFacing));
  const float bend =
      faces ? clamp(dot(gradient - shown_gradient, offset), -kMostBend * unit, kMostBend * unit) : 0.0;
  const float slack = (faces ? kSlack : kSlackRoundEdge) * unit;
  return below >= min(bend, 0.0) - slack && below <= max(bend, 0.0) + slack;
}

/// The pixel that the texel's sample point projects to, if it takes part there: the pixel shows its map
/// and its place on the surface, and some of it faces the fall.
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
  const vec3 normal = texelFetch(triangle_surface, int(texelFetch(texels, index).x)).xyz;
  const vec3 shown_normal = texelFetch(triangle_surface, int(seen.x) - 1).xyz;
  const float facing = -dot(normal, fall.direction.xyz);
  if (!is_shown(projected.xy - vec2(pixel + tile_origin) - 0.5, projected.z, normal, facing,
                uintBitsToFloat(seen.y), shown_normal, max(uintBitsToFloat(seen.w), kLeastFacing))) {
    return none;
  }
  // Where its point faces away, the texel may reach round an edge into the fall.
  const float area = facing > 0.0 ? surface.w * facing : facing_area(index);
  const float weight = area / (fall.direction.w * fall.direction.w) * float(kPixelWeight);
  // A texel of hundreds of pixels is met by the pixels' centres as well as can be.
  if (weight < 0.5 || weight >= 256.0 * float(kPixelWeight)) {
    return none;
  }
  return TexelTarget(packed_pixel(pixel), uint(weight + 0.5));
}
