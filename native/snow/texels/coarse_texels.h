#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// A map with fewer, larger texels. All texels of the original belong to one of them, so that areas
/// and volumes on both agree in every pose.
struct CoarseTexels {
  /// Of a map with resolution / side texels a side. A texel's chart is the one that covers most of
  /// its square; texels of other charts belong to the nearest square of their own.
  TexelTable table;
  /// The original's texels in coarse texel i, ascending: texel[begin[i]] to before
  /// texel[begin[i + 1]].
  std::vector<int32_t> begin;
  std::vector<int32_t> texel;
  /// Per coarse texel: the one of them nearest to its middle.
  std::vector<int32_t> middle;
  /// Per texel of the original: its coarse texel.
  std::vector<int32_t> parent;
};

/// Joins squares of `side` x `side` texels, a power of two. None if the resolution is no multiple
/// of it, or if a chart is too small for the squares: it would lose its snow. O(texels).
std::optional<CoarseTexels> join_texels(const TexelTable& table, int32_t side);

}  // namespace snowbough::snow
