#include "tree/surface/stations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

using Kind = Station::Kind;

/// A joint closer to a knuckle than this (in corner radii) loses its ring: a shorter row of faces
/// would show as a dark line around the limb.
constexpr double kJointClearance = 0.3;
/// Minimum distance of a tilted joint's ring from a knuckle's on all its sides (in corner radii).
constexpr double kTiltClearance = 0.15;
/// Length kept free beside a sharp bend, in corner radii.
constexpr double kBendClearance = 0.1;
/// Maximum number of tilting sweeps.
constexpr int kTiltSweeps = 4;

/// Cosine of the angle at which a bend is sharp.
constexpr double kSharp = 0.5;

/// Cosine between the segments that meet at an inner point.
double bend_cosine(const LimbPath& path, size_t point) {
  return glm::dot(glm::normalize(path.points[point] - path.points[point - 1]),
                  glm::normalize(path.points[point + 1] - path.points[point]));
}

bool is_knuckle(const Station& station) {
  return station.kind == Kind::kKnuckleBegin || station.kind == Kind::kKnuckleEnd;
}

/// Whether ring `b` reaches behind the plane of ring `a`, or `a` in front of the plane of `b`, for
/// any roll.
bool cut_each_other(const Station& a, const Station& b, double margin) {
  const double cosine = glm::dot(a.normal, b.normal);
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  const glm::dvec3 step = b.centre - a.centre;
  return glm::dot(step, a.normal) - b.corner * sine < margin ||
         glm::dot(step, b.normal) - a.corner * sine < margin;
}

std::array<Station, 2> knuckle_stations(const LimbPath& path, const Knuckle& knuckle, int index,
                                        const LengthLimits& scale) {
  const double length = knuckle.end - knuckle.begin;
  Station begin, end;
  begin.kind = Kind::kKnuckleBegin;
  end.kind = Kind::kKnuckleEnd;
  begin.knuckle = end.knuckle = index;
  begin.centre = position_at(path, knuckle.begin);
  end.centre = position_at(path, knuckle.end);
  begin.corner = corner_at(path, knuckle.begin);
  end.corner = corner_at(path, knuckle.end);
  for (const ChildRequest& child : knuckle.children) {
    // A second stem is as wide as it is: its side may be narrower.
    if (child.crotch) continue;
    begin.corner = std::max(begin.corner, std::sqrt(0.5) * child.width);
    end.corner = std::max(end.corner, std::sqrt(0.5) * child.width);
  }
  begin.bone_length = bone_length_at(path, knuckle.begin);
  end.bone_length = bone_length_at(path, knuckle.end);
  const glm::dvec3 chord = end.centre - begin.centre;
  const double distance = glm::length(chord);
  if (distance >= 0.5 * length && distance >= 0.5 * scale.smallest_knuckle) {
    begin.normal = end.normal = chord / distance;
  } else {
    // The limb turns back inside the knuckle: continue straight instead.
    begin.normal = end.normal = direction_at(path, knuckle.begin);
    end.centre = begin.centre + begin.normal * std::max(0.5 * length, scale.smallest_knuckle);
  }
  return {begin, end};
}

/// Drops joint rings that cut a knuckle's ring; the limb is then straight past the joint.
void drop_cutting_joints(std::vector<Station>& stations, bool drop_all) {
  std::vector<Station> kept;
  kept.reserve(stations.size());
  for (size_t i = 0; i < stations.size(); ++i) {
    const Station& station = stations[i];
    if (station.kind == Kind::kJoint && !station.sharp) {
      const Station& before = kept.back();
      const Station& after = stations[i + 1];
      const bool beside = drop_all && kept.size() > 1;
      const double free = kTiltClearance * station.corner;
      if ((is_knuckle(before) && cut_each_other(before, station, free)) ||
          (beside && cut_each_other(before, station, 0.0)) ||
          (is_knuckle(after) && cut_each_other(station, after, free)) ||
          (drop_all && cut_each_other(station, after, 0.0))) {
        continue;
      }
    }
    kept.push_back(station);
  }
  stations.swap(kept);
}

/// Both rings of a knuckle stay parallel: its other ring gets the new normal, too.
void set_normal(std::vector<Station>& stations, size_t i, const glm::dvec3& normal) {
  stations[i].normal = normal;
  if (stations[i].kind == Kind::kKnuckleBegin) {
    stations[i + 1].normal = normal;
  } else if (stations[i].kind == Kind::kKnuckleEnd) {
    stations[i - 1].normal = normal;
  }
}

void tilt_cutting_planes(std::vector<Station>& stations, const StationOptions& options) {
  for (int sweep = 0; sweep < kTiltSweeps; ++sweep) {
    bool changed = false;
    for (size_t i = options.first_is_hole ? 1 : 0; i + 1 < stations.size(); ++i) {
      Station& a = stations[i];
      Station& b = stations[i + 1];
      const bool inside_knuckle = is_knuckle(a) && a.knuckle == b.knuckle;
      const double cosine = glm::dot(a.normal, b.normal);
      if (inside_knuckle || cosine < -0.2 || cosine > 0.999999 || !cut_each_other(a, b, 0.0)) {
        continue;
      }
      const glm::dvec3 mean = mean_direction(a.normal, b.normal);
      if (i > 0) {
        set_normal(stations, i, mean);
      }
      set_normal(stations, i + 1, i > 0 ? mean : a.normal);
      changed = true;
    }
    if (!changed) {
      return;
    }
  }
}

}  // namespace

std::vector<std::pair<double, double>> sharp_bends(const LimbPath& path,
                                                   const LengthLimits& scale) {
  std::vector<std::pair<double, double>> bends;
  for (size_t i = 1; i + 1 < path.points.size(); ++i) {
    if (bend_cosine(path, i) < kSharp) {
      const double shorter =
          std::min(path.lengths[i] - path.lengths[i - 1], path.lengths[i + 1] - path.lengths[i]);
      bends.emplace_back(path.lengths[i],
                         std::max(std::min(path.corners[i], 0.25 * shorter),
                                  kBendClearance * path.corners[i] + scale.smallest_gap));
    }
  }
  return bends;
}

glm::dvec3 mean_direction(const glm::dvec3& incoming, const glm::dvec3& outgoing) {
  const glm::dvec3 sum = incoming + outgoing;
  const double length = glm::length(sum);
  return length > 0.02 ? sum / length : incoming;
}

glm::dvec3 joint_normal(const LimbPath& path, size_t point) {
  const glm::dvec3 incoming = glm::normalize(path.points[point] - path.points[point - 1]);
  if (point + 1 == path.points.size()) {
    return incoming;
  }
  return mean_direction(incoming, glm::normalize(path.points[point + 1] - path.points[point]));
}

std::vector<Station> ring_stations(const LimbPath& path, const std::vector<Knuckle>& knuckles,
                                   const LengthLimits& scale, const StationOptions& options) {
  std::vector<Station> stations;
  stations.reserve(path.points.size() + 2 * knuckles.size());
  Station first;
  first.kind = Kind::kFirst;
  first.centre = path.points.front();
  first.normal = options.first_normal;
  first.corner = path.corners.front();
  first.bone_length = path.bone_lengths.front();
  stations.push_back(first);

  size_t next_knuckle = 0;
  for (size_t i = 1; i < path.points.size(); ++i) {
    const double s = path.lengths[i];
    const double clearance = std::max(scale.smallest_gap, kJointClearance * path.corners[i]);
    const bool tip = i + 1 == path.points.size();
    while (next_knuckle < knuckles.size() &&
           (tip || knuckles[next_knuckle].begin < s + clearance)) {
      for (Station& station :
           knuckle_stations(path, knuckles[next_knuckle], static_cast<int>(next_knuckle), scale)) {
        stations.push_back(station);
      }
      ++next_knuckle;
    }
    if (!tip && next_knuckle > 0 && s < knuckles[next_knuckle - 1].end + clearance) {
      continue;
    }
    Station station;
    station.kind = tip ? Kind::kTip : Kind::kJoint;
    station.centre = path.points[i];
    station.normal =
        tip ? mean_direction(direction_at(path, s), options.end_direction) : joint_normal(path, i);
    station.corner = path.corners[i];
    station.sharp = !tip && bend_cosine(path, i) < kSharp;
    station.bone_length = path.bone_lengths[i];
    stations.push_back(station);
  }
  drop_cutting_joints(stations, options.drop_all_cutting);
  tilt_cutting_planes(stations, options);
  return stations;
}

}  // namespace snowbough::tree
