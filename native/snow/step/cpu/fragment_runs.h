#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "snow/scene/scene_object.h"

namespace snowbough::snow::cpu {

/// A receiver's fragments in the order in which the passes visit them: by work group of texels,
/// then by triangle, ascending, then by squares of kRunSquare x kRunSquare texels. A triangle is
/// then set up once for many fragments, and the visibility of a run is mostly decided at once.
struct FragmentRuns {
  /// What depends on the texel table alone, in the same order: receivers that share a table share
  /// this, too.
  struct Shared {
    std::vector<uint16_t> texel;
    std::vector<float> share;
    std::vector<float> weight_b;
    std::vector<float> weight_c;
    std::vector<float> opacity;
  };
  std::shared_ptr<const Shared> shared;

  /// Fragments of one triangle in one square of texels.
  struct Run {
    /// Index in the scene.
    uint32_t triangle;
    /// First fragment; the run ends where the next begins.
    uint32_t begin;
    /// Bounds of the fragments' centroids: weights of the second and third corner, and their sums.
    float least_b, most_b;
    float least_c, most_c;
    float least_sum, most_sum;
  };

  /// Runs of group g: [group_begin[g], group_begin[g + 1]). An end marker follows the last run.
  std::vector<uint32_t> group_begin;
  std::vector<Run> runs;
  /// Per fragment, in `shared`: its texel, counted from the group's first; its share of the
  /// triangle's area; its centroid's weights; the part of it that receives snow
  /// (snow/scene/fragment_opacity.h; empty: opaque).
  std::span<const uint16_t> texel;
  /// These, and `part`, have kRunLanes - 1 elements more: see whole_lanes.
  std::span<const float> share;
  std::span<const float> weight_b;
  std::span<const float> weight_c;
  std::span<const float> opacity;
  /// The fragment's share of its texel's area on the current vertices, without cut-away parts.
  std::vector<float> part;
};

inline constexpr int32_t kRunSquare = 16;
/// Maximum number of fragments of a run: TexelTable has one fragment per triangle and texel.
inline constexpr size_t kMaxInRun = size_t{kRunSquare} * kRunSquare;

/// Vector length of the loops over a run's fragments. They overrun to a full vector: handling the
/// remainder one by one would take as long as the rest.
inline constexpr uint32_t kRunLanes = 8;
static_assert(kMaxInRun % kRunLanes == 0);

/// Number of fragments that such a loop visits.
inline uint32_t whole_lanes(uint32_t count) {
  return (count + kRunLanes - 1) / kRunLanes * kRunLanes;
}

/// `order`: the receiver's texels from texel_order; its triangles begin at `first_triangle` in the
/// scene. O(fragments), on all cores.
FragmentRuns make_fragment_runs(const SceneObject& object, const std::vector<int32_t>& order,
                                uint32_t first_triangle);

/// The same for an object with an equal table and opacity, from those of another whose triangles
/// begin `ahead` before its own (modulo 2^32). O(fragments) bytes of memory, O(runs) time. Copies
/// share 14 bytes a fragment; a bake of 60 copies takes 5 % less time.
FragmentRuns with_own_triangles(const FragmentRuns& other, uint32_t ahead);

}  // namespace snowbough::snow::cpu
