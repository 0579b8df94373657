#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "base/parallel_for.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Faces laid flat together: [first_face, last_face) of LeafCharts::faces.
struct LeafChart {
  int32_t first_face = 0;
  int32_t last_face = 0;
  /// Extent in metres; positive.
  glm::dvec2 size{0.0};
};

/// The leaves, laid flat one by one.
struct LeafCharts {
  /// In the order of their leaves.
  std::vector<LeafChart> charts;
  /// All faces of three or more corners, chart by chart.
  std::vector<int32_t> faces;
  /// One per corner of Foliage::corner_vertex, in metres from the lower left of its chart's
  /// bounding box; 0 for corners of no chart.
  std::vector<glm::vec2> points;
};

/// Lays every leaf flat. A leaf that is one flat or slightly bent island keeps its shape, projected
/// along its mean normal with its longer side upright. Leaves of several islands (crossed planes)
/// get one chart per island, and an island that would overlap itself (needle tubes, spheres) one
/// per face. A face without area becomes a tiny regular polygon.
/// @param foliage  with consistent arrays.
/// @throws Cancelled when execution's progress says stop.
LeafCharts flatten_leaves(const Foliage& foliage, const base::Execution& execution = {});

}  // namespace snowbough::tree
