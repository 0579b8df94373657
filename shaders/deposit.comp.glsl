// The deposit of one tile, see texel_gain.h.
#include "lib/texel_gain.h"
#include "glsl/texel_fragments.glsl"
#include "glsl/texel_group.glsl"

layout(local_size_x = 64) in;
/// Per work group of texels: its object's slot.
uniform usamplerBuffer group_slots;
/// By slot: offset from a scene triangle's index to its index in the map triangles.
uniform isamplerBuffer map_offsets;
#ifdef WITH_OPACITY
/// Per fragment: the part of it that receives snow.
uniform samplerBuffer fragment_opacity;
#endif
/// A TexelStep each, as one vector.
layout(std430) buffer TexelSteps { uvec4 texel_steps[]; };
/// Whether texel_steps holds the deposit of the step's earlier tiles.
uniform int adds_to_gain;

/// Gain of a fragment under open sky, relative to the thickness perpendicular to the fall; `surface`: its triangle's.
float falling_on(uvec4 fragment, vec4 surface) {
#ifdef WITH_SHADING
  if (is_smooth(fragment.x)) {
    const SmoothTriangle points = smooth_triangle(fragment.x);
    const vec2 there = points.corner.xy + uintBitsToFloat(fragment.z) * points.edge_b.xy +
                       uintBitsToFloat(fragment.w) * points.edge_c.xy;
    return smooth_facing(there.x, there.y, surface);
  }
#endif
  return surface_facing(surface);
}

void main() {
  const int map_offset = texelFetch(map_offsets, int(texelFetch(group_slots, listed_group()).x)).x;
  const int index = listed_texel();
  const int begin = int(texelFetch(fragment_begin, index).x);
  const int end = int(texelFetch(fragment_begin, index + 1).x);
  const FragmentSum sum = sum_of_fragments(begin, end);
  const bool mixed = sum.faces_positive && sum.faces_back;
  uint gain = adds_to_gain != 0 ? texel_steps[index].x & ~(kBackSide | kMixedSides) : 0u;
  for (int i = begin; i < end; ++i) {
    const uvec4 fragment = texelFetch(fragments, i);
    const vec4 surface = texelFetch(triangle_surface, int(fragment.x));
    float area = uintBitsToFloat(fragment.y) * surface_area(surface);
#ifdef WITH_OPACITY
    area *= texelFetch(fragment_opacity, i).x;
#endif
    if (surface_facing(surface) > 0.0f && area > 0.0f) {
      const GainTriangle own = gain_triangle(int(fragment.x), int(fragment.x) + map_offset);
      const float falls = falling_on(fragment, surface) * (area / sum.surface.area);
      gain += fragment_gain(fragment.x, uintBitsToFloat(fragment.y),
                            vec2(uintBitsToFloat(fragment.z), uintBitsToFloat(fragment.w)), own,
                            falls * gain_units(mixed))
              << gain_shift(mixed, shows_back(surface));
    }
  }
  texel_steps[index] = uvec4(gain | gain_sides(mixed, sum.faces_back), floatBitsToUint(sum.surface.area),
                             floatBitsToUint(sum.surface.up), floatBitsToUint(sum.surface.back_up));
}
