#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "base/parallel_for.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// The foliage's `snow` UV map.
struct LeafUvs {
  /// One per corner of Foliage::corner_vertex.
  std::vector<glm::vec2> corner_uv;
  int64_t chart_count = 0;
  /// What the layout was made for: the resolution asked for, or, where its texels do not suffice
  /// for all charts, the smallest power of two that does suffice.
  int resolution = 0;
  /// Texels a metre along both axes, but where a chart was widened to two texels.
  double scale = 0.0;

  bool fits(int asked_resolution) const { return resolution <= asked_resolution; }
};

/// Lays every leaf out once, without overlap, for a map of `resolution` squared texels, so that
/// snow lies on each leaf by itself.
///
/// A leaf that is one flat or slightly bent island keeps its own shape, seen along its mean normal
/// with its longer side upright; leaves of several islands (crossed planes) take one chart an
/// island, and an island that would fold upon itself (needle tubes, spheres) one a face. All charts
/// have the same scale, but at least two texels of width and height. Between two charts at least
/// one texel stays free, two where the layout has charts wider than four texels, and one along the
/// border. Every face of three or more corners has positive area. The scale is the largest but for
/// a thousandth. flatten_leaves makes the charts.
///
/// @param resolution  16 to 16384.
/// @throws Cancelled when execution's progress says stop.
/// @throws std::invalid_argument if resolution is out of range, if the foliage's arrays contradict
///   each other, or if the charts fit on no map up to 16384.
LeafUvs layout_leaf_uvs(const Foliage& foliage, int resolution,
                        const base::Execution& execution = {});

}  // namespace snowbough::tree
