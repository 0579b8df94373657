#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/triangle_tree.h"
#include "snow/surface/nearest_points.h"
#include "snow/surface/surface_points.h"

namespace snowbough::snow {

/// A point on a slope in a hollow, as a bowl: above a level place whose snow may bury it, or before
/// a wall opposite. Its snow is drawn along the vertical: along the normal it would lie within that
/// of the level place, or meet that on the wall.
struct Bank {
  int32_t point = -1;
  /// Points of the level place, which give the thickness there.
  PointMean level;
  /// Height of the point above the level place, in metres; 0: there is none.
  float above = 0.0f;
  /// Distance to the wall in metres.
  float across = std::numeric_limits<float>::infinity();
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
