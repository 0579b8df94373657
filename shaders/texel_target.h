// GLSL only: which pixel a texel takes its snow from. Both formulations of the deposit include it.
#include "fall_frame.h"
#include "packed_pixel.h"
#include "texel_parts.h"
#include "tile_pixel.h"
#include "triangle_object.h"

// Buffer textures instead of storage blocks: llvmpipe reads a whole vector at once from them, and
// OpenGL 4.1 has no storage blocks.
uniform usamplerBuffer texels;
/// See triangle_fall.h.
uniform samplerBuffer triangle_corners;
/// The same, number by number.
uniform samplerBuffer corner_words;
/// Per work group of texels: its object's slot.
uniform usamplerBuffer group_slots;
/// What the sky sees: 1 + triangle with kBackFace, 0 = nothing; and its depth, as the depth test keeps it.
uniform usamplerBuffer occlusion;
uniform samplerBuffer occlusion_depth;
uniform ivec2 tile_origin;

/// How far a texel's point may lie from what its pixel shows, in pixels over the shallower slope. Beyond
/// the two planes: what lies between them may be rougher than they are, and more so round an edge.
const float kSlack = 0.25;
const float kSlackRoundEdge = 0.5;
/// Between the two planes: a wall's own slope would let it reach far below an edge.
const float kMostBend = 1.0;
const float kLeastFacing = 1e-4;

/// A triangle's plane over the grid: depth that it gains in one pixel along each axis, and its facing.
struct Plane {
  vec2 gradient;
  float facing;
};

Plane plane_of(int triangle) {
  const int first = 12 * triangle;
  return Plane(
      vec2(texelFetch(corner_words, first + 3).x, texelFetch(corner_words, first + 7).x),
      texelFetch(corner_words, first + 11).x);
}

/// Whether a texel's point, `offset` pixels from the centre of a pixel, lies on what the pixel shows at
/// depth `shown_depth`: on the shown plane extended to the point, on the texel's own plane extended from
/// what is shown, or between them, where the surface bends between the centre and the point. What lies
/// below another surface with the same slopes lies below both planes.
bool is_shown(vec2 offset, float depth, Plane own, float shown_depth, Plane shown) {
  const float below = depth - shown_depth - dot(shown.gradient, offset);
  const float unit = fall.direction.w / max(max(own.facing, shown.facing), kLeastFacing);
  const bool faces = own.facing > 0.0;
  const float bend =
      faces ? clamp(dot(own.gradient - shown.gradient, offset), -kMostBend * unit, kMostBend * unit) : 0.0;
  const float slack = (faces ? kSlack : kSlackRoundEdge) * unit;
  return below >= min(bend, 0.0) - slack && below <= max(bend, 0.0) + slack;
}

/// The pixel that the texel's sample point projects to, if it takes part there: the pixel shows its map
/// and its place on the surface, and some of it faces the fall.
TexelStep step_of(int index) {
  const TexelParts parts = parts_of(index);
  const TexelStep none = TexelStep(0u, 0u, parts.area, parts.up);
  const uvec4 texel = texelFetch(texels, index);
  const vec4 a = texelFetch(triangle_corners, 3 * int(texel.x));
  const vec4 b = texelFetch(triangle_corners, 3 * int(texel.x) + 1);
  const vec4 c = texelFetch(triangle_corners, 3 * int(texel.x) + 2);
  const vec3 point =
      a.xyz + uintBitsToFloat(texel.z) * (b.xyz - a.xyz) + uintBitsToFloat(texel.w) * (c.xyz - a.xyz);
  const Plane own = Plane(vec2(a.w, b.w), c.w);
  const vec2 corner = floor(point.xy);
  const ivec2 pixel = ivec2(corner) - tile_origin;
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, tile_size))) {
    return none;
  }
  const uint seen = texelFetch(occlusion, pixel_index(pixel)).x;
  if (seen == 0u || (seen & kBackFace) != 0u) {
    return none;
  }
  const Plane shown = plane_of(int(seen) - 1);
  const float shown_depth = texelFetch(occlusion_depth, pixel_index(pixel)).x / fall.range.y + fall.range.x;
  const uint slot = texelFetch(group_slots, index / int(kTexelGroup)).x | kReceives;
  if (object_of(seen - 1u) != slot ||
      !is_shown(point.xy - corner - 0.5, point.z, own, shown_depth, shown)) {
    return none;
  }
  // Where its point faces away, the texel may reach round an edge into the fall.
  const float area = own.facing > 0.0 ? parts.area * own.facing : parts.facing_area;
  const float weight = area / (fall.direction.w * fall.direction.w) * float(kPixelWeight);
  // A texel of hundreds of pixels is met by the pixels' centres as well as can be.
  if (weight < 0.5 || weight >= 256.0 * float(kPixelWeight)) {
    return none;
  }
  return TexelStep(packed_pixel(pixel), uint(weight + 0.5), parts.area, parts.up);
}
