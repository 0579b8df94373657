// Loops over the fragments of a texel.
#include "../lib/facing.h"
#include "../lib/texel_surface.h"

KERNEL_VIEW_R32UI(fragment_begin);
/// One Fragment per element.
KERNEL_VIEW_RGBA32UI(fragments);

/// Sums over a texel's fragments.
struct FragmentSum {
  TexelSurface surface;
  /// True if any fragment faces the snowfall with its positive side, or with its back.
  bool faces_positive;
  bool faces_back;
};

/// Upward component of the normal on a fragment; `surface`: that of its triangle.
float fragment_up(uvec4 fragment, vec4 surface) {
#ifdef WITH_SHADING
  if (is_smooth(fragment.x)) {
    const SmoothTriangle smooth_values = smooth_triangle(fragment.x);
    return between(smooth_values.corner.z, smooth_values.edge_b.z, smooth_values.edge_c.z, uintBitsToFloat(fragment.z),
                   uintBitsToFloat(fragment.w));
  }
#endif
  return surface_up(surface);
}

/// Sums over the fragments [i, end) of a texel.
FragmentSum sum_of_fragments(int i, int end) {
  FragmentSums sums = FragmentSums(0.0f, 0.0f, 0.0f, 0.0f, 0.0f);
  bool faces_positive = false;
  bool faces_back = false;
  // Tested at the end for software renderers (CONTRIBUTING.md).
  do {
    const uvec4 fragment = texelFetch(fragments, i);
    const vec4 surface = texelFetch(triangle_surface, int(fragment.x));
    const float area = i < end ? uintBitsToFloat(fragment.y) * surface_area(surface) : 0.0f;
    sums = with_fragment(sums, area, fragment_up(fragment, surface), surface_side(surface) != 0.0f);
    const bool faces = i < end && surface_facing(surface) > 0.0f;
    faces_positive = faces_positive || (faces && !shows_back(surface));
    faces_back = faces_back || (faces && shows_back(surface));
  } while (++i < end);
  return FragmentSum(surface_of_sums(sums), faces_positive, faces_back);
}
