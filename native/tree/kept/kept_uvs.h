#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "base/parallel_for.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// UV maps of the kept surface, per corner.
struct KeptUvs {
  /// Without overlap, for snow.
  std::vector<glm::vec2> snow;
  /// Resolution of the layout: the requested one or, if its charts do not fit, the smallest power
  /// of two at which they do.
  int resolution = 0;
  int64_t chart_count = 0;
  /// Once around the limb, and along it with the texture's aspect kept, for tiling bark.
  std::vector<glm::vec2> bark;
};

/// Lays out a kept surface. Its charts are compact regions of one branch whose polygons face nearly
/// one way, projected flat (layout_leaf_uvs packs them); so an area on the map is at least half of
/// that on the surface.
/// @param skeleton  with an attached kept surface; branches before or after simplification.
/// @throws as layout_leaf_uvs.
KeptUvs layout_kept_uvs(const Skeleton& skeleton, int resolution,
                        const base::Execution& execution = {});

}  // namespace snowbough::tree
