#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "tree/skeleton/skeleton.h"
#include "tree/skeleton/width.h"
#include "tree/surface/strip_tree.h"

namespace snowbough::tree {

/// Length limits of the surface, in metres, all relative to the tree's height.
struct LengthLimits {
  double height = 1.0;
  /// Points closer than this coincide.
  double coincident = 0.0;
  /// Smallest distance of a ring's corner from its centre; the ring's inscribed circle then still
  /// has kSmallestRadius.
  double smallest_corner = 0.0;
  /// Smallest length of a knuckle along its limb.
  double smallest_knuckle = 0.0;
  /// Smallest distance between two rings that are not of one knuckle.
  double smallest_gap = 0.0;
};

/// @throws std::invalid_argument for a skeleton without branches or with a non-finite position.
LengthLimits length_limits(const Skeleton& skeleton);

/// A centreline that the surface follows: at least two points, no segment of zero length.
struct LimbPath {
  std::vector<glm::dvec3> points;
  /// Distance of each corner of the ring from the centre: sqrt(area / 2), so that a square ring
  /// preserves the limb's volume, and at least LengthLimits::smallest_corner.
  std::vector<double> corners;
  /// Arc length of each point; 0 at the first.
  std::vector<double> lengths;
  /// Arc length of each point along the branch's own centreline, which bones refer to. Differs from
  /// `lengths` once the part inside the parent has been removed.
  std::vector<double> bone_lengths;
  /// Arc length from which children may leave: before it a ring would cut the parent.
  double clear_from = 0.0;

  double length() const { return lengths.back(); }
};

/// Recomputes `lengths` from `points`.
void measure(LimbPath& path);

/// The centreline of every branch without zero-length segments. A branch of a single point becomes
/// a short segment away from its parent (upwards for a root), so that no branch is lost.
std::vector<LimbPath> limb_paths(const Skeleton& skeleton, const Widths& widths,
                                 const LengthLimits& scale);

/// Index of the segment that contains arc length `s`, for ascending `lengths`; at a point, the
/// segment before it.
int32_t segment_at(const std::vector<double>& lengths, double s);

/// Position, corner radius, bone length and direction at arc length `s` (clamped to the path).
glm::dvec3 position_at(const LimbPath& path, double s);
double corner_at(const LimbPath& path, double s);
double bone_length_at(const LimbPath& path, double s);
glm::dvec3 direction_at(const LimbPath& path, double s);

/// Arc length of the place on the path nearest to `point`, the first of several.
double nearest_length(const LimbPath& path, const glm::dvec3& point);

/// Repeated nearest-place queries on a path, in about logarithmic time each. The path must outlive
/// it and keep its points.
class PathSearch {
 public:
  explicit PathSearch(const LimbPath& path) : path_(path), tree_(path.points) {}

  const LimbPath& path() const { return path_; }

  /// The same as nearest_length(path, point), to the bit.
  double nearest_length(const glm::dvec3& point) const;

 private:
  const LimbPath& path_;
  StripTree tree_;
};

}  // namespace snowbough::tree
