#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// A place on a branch's centreline.
struct CentrelinePlace {
  /// The segment from points[segment] to points[segment + 1]; 0 for a branch of one point.
  size_t segment = 0;
  /// 0..1 along it.
  float t = 0.0f;
  glm::vec3 point{0.0f};
};

/// The place nearest to `point`; on a tie the one closest to the root.
CentrelinePlace nearest_place(const Branch& branch, const glm::vec3& point);

/// Distance along the centreline from the root to every point; the first is 0, the last the length.
std::vector<float> arc_lengths(const Branch& branch);

/// Sum of the distances between successive points.
float polyline_length(const std::vector<glm::vec3>& points);

/// Radius and area at a place. The radius is interpolated linearly along the segment, and so is the
/// square root of the area, as in a cone.
float radius_at(const Branch& branch, const CentrelinePlace& place);
float area_at(const Branch& branch, const CentrelinePlace& place);

}  // namespace snowbough::tree
