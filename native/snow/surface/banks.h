#pragma once

#include <cstdint>
#include <vector>

#include "base/triangle_tree.h"
#include "snow/surface/nearest_points.h"
#include "snow/surface/surface_points.h"

namespace snowbough::snow {

/// A point of a hollow such as a bowl: on a slope above a level place whose snow may bury it, or on
/// that level place. Buried snow is drawn along the vertical: normals that lean together would push
/// it into itself.
struct Bank {
  int32_t point = 0;
  /// How far it belongs to the hollow, 0 to 1.
  float share = 0.0f;
  /// Points halfway down to the level place and points of that place, which give the snow there.
  PointMean halfway, level;
  /// Height of the point above halfway, and of halfway above the level place, in metres.
  float above = 0.0f;
  float halfway_above = 0.0f;
};

/// @param tree a tree over the triangles of `receiver`.
/// @param lying the points that snow can lie on.
std::vector<Bank> find_banks(const SurfacePoints& points, const SurfaceMesh& receiver,
                             const base::TriangleTree& tree, const NearestPoints& lying,
                             float depth);

/// Moves the offsets of buried points to the vertical.
/// @param column height of the snow along the vertical, of all points, in metres.
void bury_banks(const std::vector<Bank>& banks, const std::vector<float>& column, float depth,
                std::vector<glm::vec3>& offsets);

}  // namespace snowbough::snow
