#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "tree/surface/limb_path.h"

namespace snowbough::tree {

/// A smooth curve through the joints of a limb, and its thickness along it.
///
/// At a joint it has the mean direction of the two segments that meet there. On each segment it
/// leaves the straight line by the cubic Hermite curve of its ends' directions where that stays
/// close to the line; where it would stray further than allowed, each end's share of the bulge dies
/// out sooner, so that the limb turns beside the joint and runs straight in between; but at sharp
/// joints it turns around no smaller circle than its corners lie on. Thickness is a monotone cubic
/// through the joints' (F. N. Fritsch and R. E. Carlson, "Monotone Piecewise Cubic Interpolation",
/// SIAM Journal on Numerical Analysis 17(2), 1980).
class LimbCurve {
 public:
  /// @param before, after  unit directions in which the limb comes and goes on, where it is part of
  ///   a longer one; zero: it ends there.
  /// @param thin_stray  how far the thinnest limbs may stray, metres; thick ones by a share of
  /// their
  ///   radius.
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
    /// Sideways slope of the curve at both ends, times the segment's length, and how far from each,
    /// as a share of the length, its bulge reaches.
    glm::dvec3 begin_slope{0.0}, end_slope{0.0};
    double begin_reach = 1.0, end_reach = 1.0;
    double length = 0.0;
    double begin_corner = 0.0, end_corner = 0.0;
    /// Change of the corner a metre at both ends.
    double begin_taper = 0.0, end_taper = 0.0;
  };

  const Segment& segment_of(double s, double& t) const;

  std::vector<double> lengths_;
  std::vector<Segment> segments_;
};

}  // namespace snowbough::tree
