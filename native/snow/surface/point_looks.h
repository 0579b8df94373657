#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/triangle_tree.h"
#include "shaders/lib/snow_surface.h"
#include "snow/surface/height_samples.h"
#include "snow/surface/rim_zones.h"
#include "snow/surface/surface_points.h"

namespace snowbough::snow {

/// Constants of the look of snow at each point.
struct PointLooks {
  std::vector<shared::SnowPoint> point;
  /// 1 for points on sheets, which are parts without a back side.
  std::vector<uint8_t> is_sheet;
};

/// All but the bumps, which depend on the shown points, as in the end does the relief.
/// @param tree a tree over the receiver's triangles.
/// @param zone the rim zones of the points.
/// @param noise_shift offset of positions in noise space, in depths.
PointLooks point_looks(const SurfacePoints& points, const HeightSamples& samples,
                       const std::vector<RimZones::Zone>& zone, const base::TriangleTree& tree,
                       const glm::vec3& noise_shift, float depth);

/// Sets the bumps and the relief: snow of two pieces that meets has the same ones there. `shown`:
/// points of the surface in the last frame.
void set_relief(PointLooks& looks, const std::vector<glm::vec3>& shown,
                const glm::vec3& noise_shift, float depth);

}  // namespace snowbough::snow
