#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "snow/scene/scene_object.h"

namespace snowbough::snow::cpu {

/// A receiver's fragments in the order in which the passes go through them: a work group of texels
/// after the other, in each triangle by triangle, ascending, and a triangle's in squares of
/// kRunSquare x kRunSquare texels. So a triangle is set up once for many fragments, and what they
/// see of the sky is mostly decided for all of a run at once.
struct FragmentRuns {
  /// Fragments of one triangle in one square of texels.
  struct Run {
    /// Of the scene.
    uint32_t triangle;
    /// Its fragments end where those of the next begin.
    uint32_t begin;
    /// Between which their centroids lie: weights of the second and of the third corner, and the
    /// sums of both.
    float least_b, most_b;
    float least_c, most_c;
    float least_sum, most_sum;
  };

  /// Runs of group g: [group_begin[g], group_begin[g + 1]). Behind the last one stands an end.
  std::vector<uint32_t> group_begin;
  std::vector<Run> runs;
  /// Per fragment: its texel, counted from the group's first; its share of the
  /// triangle's area; its centroid's weights; the part of it that is there for snow
  /// (snow/scene/fragment_opacity.h), empty: opaque.
  std::vector<uint16_t> texel;
  /// These, and `part`, have kRunLanes - 1 elements more: see whole_lanes.
  std::vector<float> share;
  std::vector<float> weight_b;
  std::vector<float> weight_c;
  std::vector<float> opacity;
  /// What part of its texel's area it is on the current vertices; of what is there for snow only.
  std::vector<float> part;
};

inline constexpr int32_t kRunSquare = 16;
/// Most fragments of a run. TexelTable has one of a triangle in a texel.
inline constexpr size_t kMostInRun = size_t{kRunSquare} * kRunSquare;

/// Loops over a run's fragments go on to the end of a vector of so many: what is left of a run
/// would take one at a time as long as the rest.
inline constexpr uint32_t kRunLanes = 8;
static_assert(kMostInRun % kRunLanes == 0);

/// Fragments that such a loop goes over.
inline uint32_t whole_lanes(uint32_t count) {
  return (count + kRunLanes - 1) / kRunLanes * kRunLanes;
}

/// `order`: the receiver's texels as texel_order gives them; its triangles begin at
/// `first_triangle` of the scene. O(fragments), on all cores.
FragmentRuns make_fragment_runs(const SceneObject& object, const std::vector<int32_t>& order,
                                uint32_t first_triangle);

}  // namespace snowbough::snow::cpu
