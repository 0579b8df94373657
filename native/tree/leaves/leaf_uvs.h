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
  /// Resolution of the layout: the requested one or, if all charts do not fit, the smallest power
  /// of two at which they do.
  int resolution = 0;
  /// Texels per metre along both axes, except for charts widened to two texels.
  double scale = 0.0;

  bool fits(int asked_resolution) const { return resolution <= asked_resolution; }
};

/// Lays out every leaf once, without overlap, for a map of `resolution` squared texels, so that
/// each leaf has its own snow.
///
/// A leaf that is one flat or slightly bent island keeps its shape, projected along its mean normal
/// with its longer side upright. Leaves of several islands (crossed planes) get one chart per
/// island, and an island that would overlap itself (needle tubes, spheres) one per face. All charts
/// have the same scale, but at least two texels of width and height. Between two charts at least
/// one texel is free, two if the layout has charts wider than four texels, and one along the
/// border. Every face of three or more corners has positive area. The scale is within a thousandth
/// of the largest. flatten_leaves makes the charts.
///
/// @param resolution  16 to 16384.
/// @throws Cancelled when execution's progress says stop.
/// @throws std::invalid_argument if resolution is out of range, if the foliage's arrays are
/// inconsistent, or if the charts do not fit a map of 16384.
LeafUvs layout_leaf_uvs(const Foliage& foliage, int resolution,
                        const base::Execution& execution = {});

}  // namespace snowbough::tree
