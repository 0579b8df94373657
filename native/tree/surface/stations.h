#pragma once

#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "tree/surface/knuckles.h"
#include "tree/surface/limb_path.h"

namespace snowbough::tree {

/// The place of a ring along a limb.
struct Station {
  enum class Kind { kFirst, kJoint, kKnuckleBegin, kKnuckleEnd, kTip };
  Kind kind = Kind::kJoint;
  glm::dvec3 centre{0.0};
  /// Unit normal of the ring's plane, along the limb.
  glm::dvec3 normal{0.0, 0.0, 1.0};
  double corner = 0.0;
  double bone_length = 0.0;
  /// At a sharp bend: the ring is never dropped.
  bool sharp = false;
  /// For the two rings of a knuckle: its index.
  int knuckle = -1;
};

struct StationOptions {
  /// Normal of the first ring; given by the parent if there is one.
  glm::dvec3 first_normal{0.0, 0.0, 1.0};
  /// The first ring is a hole in the parent's side: its plane does not follow the limb.
  bool first_is_hole = false;
  /// Direction in which the limb continues beyond its end; its own end direction if it does not.
  glm::dvec3 end_direction{0.0, 0.0, 1.0};
  /// Drop joint rings that cut each other, instead of only tilting them.
  bool drop_all_cutting = false;
};

/// Rings along a limb: one at every joint, perpendicular to the mean tangent (at a reversal, to the
/// incoming one), and two parallel ones for every knuckle. A joint inside a knuckle loses its ring,
/// and so does one whose ring would cut a knuckle's. Planes that would otherwise cut each other are
/// tilted.
std::vector<Station> ring_stations(const LimbPath& path, const std::vector<Knuckle>& knuckles,
                                   const LengthLimits& scale, const StationOptions& options);

/// Joints where the limb turns by more than 60 degrees: arc length, and the length beside them to
/// keep free of knuckles.
std::vector<std::pair<double, double>> sharp_bends(const LimbPath& path, const LengthLimits& scale);

/// Normal of the ring at an inner point of a path.
glm::dvec3 joint_normal(const LimbPath& path, size_t point);

/// Unit mean of two unit directions; the first one if they are opposite.
glm::dvec3 mean_direction(const glm::dvec3& incoming, const glm::dvec3& outgoing);

}  // namespace snowbough::tree
