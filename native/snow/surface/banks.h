#pragma once

#include <cstdint>
#include <vector>

#include "base/triangle_tree.h"
#include "snow/surface/nearest_points.h"
#include "snow/surface/surface_points.h"

namespace snowbough::snow {

/// A point on a slope above a level place whose snow may bury it, as in a bowl. Buried snow is
/// drawn along the vertical: along the normal it would lie within the snow of the level place.
struct Bank {
  int32_t point = 0;
  /// Points of the level place, which give the thickness there.
  PointMean level;
  /// Height of the point above the level place, in metres.
  float above = 0.0f;
  /// How far its offset turns to the vertical where it is buried, 0 to 1.
  float share = 1.0f;
  /// 1 on steep slopes, whose snow ends at the top of that of the level place; 0 on gentle ones,
  /// which have at least their own snow.
  float steep = 1.0f;
  /// Greatest height of its snow, as a factor on that of the column over it.
  float column = 1.0f;
};

/// @param tree a tree over the triangles of `receiver`.
/// @param lying the points that snow can lie on.
std::vector<Bank> find_banks(const SurfacePoints& points, const SurfaceMesh& receiver,
                             const base::TriangleTree& tree, const NearestPoints& lying,
                             float depth);

/// Moves the offsets of buried points to the vertical.
/// @param thickness, shown, up as in heights_now.
void bury_banks(const std::vector<Bank>& banks, const std::vector<float>& thickness,
                const std::vector<float>& shown, const std::vector<float>& up, float depth,
                std::vector<glm::vec3>& offsets);

}  // namespace snowbough::snow
