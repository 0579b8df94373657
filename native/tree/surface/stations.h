#pragma once

#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "tree/surface/knuckles.h"
#include "tree/surface/limb_path.h"

namespace snowbough::tree {

/// A place along a limb where a ring stands.
struct Station {
  enum class Kind { kFirst, kJoint, kKnuckleBegin, kKnuckleEnd, kTip };
  Kind kind = Kind::kJoint;
  glm::dvec3 centre{0.0};
  /// Unit normal of the ring's plane, along the limb.
  glm::dvec3 normal{0.0, 0.0, 1.0};
  double corner = 0.0;
  double bone_length = 0.0;
  /// At a joint that bends sharply: the ring stays whatever happens beside it.
  bool sharp = false;
  /// For the two rings of a knuckle: its index.
  int knuckle = -1;
};

struct StationOptions {
  /// Normal of the first ring; fixed when a parent gave it.
  glm::dvec3 first_normal{0.0, 0.0, 1.0};
  /// The first ring is a hole in the parent's side: its plane does not follow the limb.
  bool first_is_hole = false;
  /// Direction in which the limb goes on behind its end; the end's own one where nothing follows.
  glm::dvec3 end_direction{0.0, 0.0, 1.0};
  /// Joint rings that cut each other are left out too, not only tilted.
  bool drop_all_cutting = false;
};

/// Rings along a limb: one at every joint, perpendicular to the mean tangent (at a reversal, to the
/// incoming one), and two parallel ones for every knuckle. A joint inside a knuckle loses its ring,
/// and so does one whose ring would cut a knuckle's. Planes that would cut each other otherwise are
/// tilted towards each other.
std::vector<Station> ring_stations(const LimbPath& path, const std::vector<Knuckle>& knuckles,
                                   const SurfaceScale& scale, const StationOptions& options);

/// Joints at which the limb turns by more than 60 degrees: arc length, and the length beside them
/// in which no knuckle should lie.
std::vector<std::pair<double, double>> sharp_bends(const LimbPath& path, const SurfaceScale& scale);

/// Normal of the ring at an inner point of a path.
glm::dvec3 joint_normal(const LimbPath& path, size_t point);

/// Unit mean of two unit directions; the first one where they are opposite.
glm::dvec3 mean_direction(const glm::dvec3& incoming, const glm::dvec3& outgoing);

}  // namespace snowbough::tree
