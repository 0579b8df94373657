#include "tree/tubes/limb_curve.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "tree/surface/stations.h"

namespace snowbough::tree {
namespace {

/// Maximum deviation of a limb from its straight segments, relative to its corner radius.
constexpr double kStray = 0.07;
/// Reduction of the thinnest limbs' allowed deviation per corner radius.
constexpr double kThinLoss = 0.5;
/// Sideways slope on both sides of a joint at which it is sharp: it turns by 48 degrees.
constexpr double kSharp = 0.45;
/// Cosine of the largest angle between a joint's direction and its segments that is followed.
constexpr double kWidestTurn = 0.35;
/// Maximum of t (1 - t)^2.
constexpr double kPeak = 4.0 / 27.0;

/// Slope 1 at 0, zero from `reach` on.
double bulge(double t, double reach) {
  if (t >= reach) {
    return 0.0;
  }
  const double left = 1.0 - t / reach;
  return t * left * left;
}

/// Taper at a joint between two segments (Fritsch and Carlson's harmonic mean).
double joint_taper(double length0, double taper0, double length1, double taper1) {
  if (taper0 * taper1 <= 0.0) {
    return 0.0;
  }
  const double w0 = 2.0 * length1 + length0, w1 = length1 + 2.0 * length0;
  return (w0 + w1) / (w0 / taper0 + w1 / taper1);
}

}  // namespace

LimbCurve::LimbCurve(const LimbPath& path, const glm::dvec3& before, const glm::dvec3& after,
                     double thin_stray)
    : lengths_(path.lengths) {
  const size_t count = path.points.size() - 1;
  segments_.resize(count);
  std::vector<double> taper(count);
  for (size_t i = 0; i < count; ++i) {
    Segment& segment = segments_[i];
    segment.begin = path.points[i];
    segment.along = path.points[i + 1] - path.points[i];
    segment.length = lengths_[i + 1] - lengths_[i];
    segment.begin_corner = path.corners[i];
    segment.end_corner = path.corners[i + 1];
    taper[i] = (segment.end_corner - segment.begin_corner) / segment.length;
  }
  const auto direction = [&](size_t i) { return segments_[i].along / segments_[i].length; };
  const auto has = [](const glm::dvec3& v) { return glm::dot(v, v) > 0.0; };
  for (size_t i = 0; i < count; ++i) {
    Segment& segment = segments_[i];
    const glm::dvec3 along = direction(i);
    const glm::dvec3 incoming = i > 0 ? direction(i - 1) : has(before) ? before : along;
    const glm::dvec3 outgoing = i + 1 < count ? direction(i + 1) : has(after) ? after : along;
    const auto slope = [&](const glm::dvec3& tangent) {
      const double cosine = glm::dot(tangent, along);
      return (tangent - along * cosine) * (segment.length / std::max(cosine, kWidestTurn));
    };
    segment.begin_slope = slope(mean_direction(incoming, along));
    segment.end_slope = slope(mean_direction(along, outgoing));
    const auto reach = [&](const glm::dvec3& sideways, double corner) {
      const double stray = std::max(kStray * corner, thin_stray - kThinLoss * corner);
      const double size = glm::length(sideways), most = kPeak * size;
      if (most <= stray) return 1.0;
      if (size < kSharp * segment.length) return stray / most;
      // At a joint the curvature is 4 size / (length^2 reach): the bend's radius must exceed the
      // limb's, otherwise its inside would fold.
      const double widest = 4.0 * size * corner / (segment.length * segment.length);
      return std::min(std::max(stray / most, widest), 1.0);
    };
    segment.begin_reach = reach(segment.begin_slope, segment.begin_corner);
    segment.end_reach = reach(segment.end_slope, segment.end_corner);
    segment.begin_taper =
        i > 0 ? joint_taper(segments_[i - 1].length, taper[i - 1], segment.length, taper[i])
              : taper[i];
    segment.end_taper =
        i + 1 < count ? joint_taper(segment.length, taper[i], segments_[i + 1].length, taper[i + 1])
                      : taper[i];
  }
}

const LimbCurve::Segment& LimbCurve::segment_of(double s, double& t) const {
  const int32_t i = segment_at(lengths_, s);
  t = std::clamp((s - lengths_[i]) / segments_[i].length, 0.0, 1.0);
  return segments_[i];
}

glm::dvec3 LimbCurve::position(double s) const {
  double t = 0.0;
  const Segment& segment = segment_of(s, t);
  return segment.begin + segment.along * t + segment.begin_slope * bulge(t, segment.begin_reach) -
         segment.end_slope * bulge(1.0 - t, segment.end_reach);
}

glm::dvec3 LimbCurve::straight_position(double s) const {
  double t = 0.0;
  const Segment& segment = segment_of(s, t);
  return segment.begin + segment.along * t;
}

double LimbCurve::straight_corner(double s) const {
  double t = 0.0;
  const Segment& segment = segment_of(s, t);
  return segment.begin_corner * (1.0 - t) + segment.end_corner * t;
}

double LimbCurve::corner(double s) const {
  double t = 0.0;
  const Segment& segment = segment_of(s, t);
  const double u = 1.0 - t;
  return segment.begin_corner * u * u * (1.0 + 2.0 * t) +
         segment.end_corner * t * t * (1.0 + 2.0 * u) +
         segment.length * (segment.begin_taper * t * u * u - segment.end_taper * t * t * u);
}

}  // namespace snowbough::tree
