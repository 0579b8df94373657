#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "tree/surface/limb_path.h"

namespace snowbough::tree {

/// A smooth curve through the joints of a limb, and its thickness along it.
///
/// At a joint its direction is the mean of both adjacent segments. Along a segment it deviates from
/// the straight line as a cubic Hermite curve with the end directions, as long as it stays close to
/// the line; where it would deviate more than allowed, the bulge at each end decays faster, so that
/// the limb turns beside the joint and is straight in between. At sharp joints it turns on no
/// smaller circle than the one of its corners. Thickness is a monotone cubic through the joints'
/// values (F. N. Fritsch and R. E. Carlson, "Monotone Piecewise Cubic Interpolation", SIAM Journal
/// on Numerical Analysis 17(2), 1980).
class LimbCurve {
 public:
  /// @param before, after  unit directions of the adjacent limbs if it is part of a longer one;
  ///   zero: it ends there.
  /// @param thin_stray  maximum deviation of the thinnest limbs, in metres; thick ones are limited
  ///   to a fraction of their radius.
  LimbCurve(const LimbPath& path, const glm::dvec3& before, const glm::dvec3& after,
            double thin_stray);

  /// Both at arc length `s` along the path's straight segments, clamped to it.
  glm::dvec3 position(double s) const;
  double corner(double s) const;

  /// Both on the straight segments.
  glm::dvec3 straight_position(double s) const;
  double straight_corner(double s) const;

  /// Arc lengths of the joints, ascending.
  const std::vector<double>& joints() const { return lengths_; }

 private:
  struct Segment {
    glm::dvec3 begin{0.0}, along{0.0};
    /// Sideways slope of the curve at both ends, times the segment's length, and the range of the
    /// bulge from each end, as a fraction of the length.
    glm::dvec3 begin_slope{0.0}, end_slope{0.0};
    double begin_reach = 1.0, end_reach = 1.0;
    double length = 0.0;
    double begin_corner = 0.0, end_corner = 0.0;
    /// Change of the corner per metre at both ends.
    double begin_taper = 0.0, end_taper = 0.0;
  };

  const Segment& segment_of(double s, double& t) const;

  std::vector<double> lengths_;
  std::vector<Segment> segments_;
};

}  // namespace snowbough::tree
