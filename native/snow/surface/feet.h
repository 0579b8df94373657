#pragma once

#include <cstdint>
#include <vector>

#include "snow/surface/nearest_points.h"
#include "snow/surface/rims.h"
#include "snow/surface/surface_points.h"

namespace snowbough::snow {

/// A point at the foot of a step that snow may hide. Maps show a furrow there, because their snow
/// is rounded off towards the step.
struct Foot {
  int32_t point = 0;
  /// The points farther off that give the thickness.
  PointMean off;
  /// Points on the step, which give the thickness there.
  PointMean upper;
  /// Height of the step above the point's face, in metres.
  float step = 0.0f;
  /// Share of that thickness, 0 to 1.
  float share = 0.0f;
};

/// True if a point with this unit normal lies at the foot of a step.
bool is_at_foot(const Rims& rims, const glm::vec3& point, const glm::vec3& normal, float depth);

/// @param lying the points that snow can lie on.
std::vector<Foot> find_feet(const SurfacePoints& points, const Rims& rims,
                            const NearestPoints& lying, float depth);

/// Fills the furrows at the feet of steps that snow hides.
void fill_feet(const std::vector<Foot>& feet, std::vector<float>& thickness);

}  // namespace snowbough::snow
