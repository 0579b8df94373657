#include "tree/surface/limb_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <utility>

namespace snowbough::tree {
namespace {

/// Maximum displacement of points relative to their corner radius, fraction of the distance to the
/// line between their neighbours per sweep, minimum distance from these as a fraction of that line;
/// and maximum number of sweeps. For bends of 60 degrees and more.
constexpr double kFairStray = 0.1;
constexpr double kFairStep = 0.7;
constexpr double kFairMargin = 0.1;
constexpr int kFairSweeps = 40;
constexpr double kFairedCosine = 0.5;
/// Minimum distance between joints of the thinnest limbs, in corner radii.
constexpr double kThinnestJoints = 2.0;

bool finite(const glm::vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

double lerp_at(const std::vector<double>& lengths, const std::vector<double>& values, double s) {
  const int32_t i = segment_at(lengths, s);
  const double t = std::clamp((s - lengths[i]) / (lengths[i + 1] - lengths[i]), 0.0, 1.0);
  return values[i] + (values[i + 1] - values[i]) * t;
}

/// The nearest place so far; of equally near ones, the one on the first segment.
struct Nearest {
  double length = 0.0;
  double square = 1e300;
  size_t segment = 0;

  void try_segment(const LimbPath& path, size_t i, const glm::dvec3& point) {
    const glm::dvec3 a = path.points[i], ab = path.points[i + 1] - a;
    const double t = std::clamp(glm::dot(point - a, ab) / glm::dot(ab, ab), 0.0, 1.0);
    const glm::dvec3 off = point - (a + ab * t);
    const double found = glm::dot(off, off);
    if (found < square || (found == square && i < segment)) {
      square = found;
      segment = i;
      length = path.lengths[i] + (path.lengths[i + 1] - path.lengths[i]) * t;
    }
  }
};

glm::dvec3 away_from_parent(const Branch& branch, const std::vector<LimbPath>& paths,
                            const LengthLimits& scale) {
  if (branch.parent < 0) {
    return {0.0, 0.0, 1.0};
  }
  const LimbPath& parent = paths[branch.parent];
  const glm::dvec3 point(branch.points.front());
  const double s = nearest_length(parent, point);
  const glm::dvec3 offset = point - position_at(parent, s);
  const double distance = glm::length(offset);
  return distance > scale.coincident ? offset / distance : direction_at(parent, s);
}

/// Whether the rings at two ends of a segment could cut each other because of the bend at point i.
bool folds_at(const LimbPath& path, size_t i) {
  const glm::dvec3 in = path.points[i] - path.points[i - 1];
  const glm::dvec3 out = path.points[i + 1] - path.points[i];
  const double before = glm::length(in), after = glm::length(out);
  const double cosine = glm::dot(in, out) / (before * after);
  if (!(cosine > kFairedCosine)) return false;
  const double half_angle = std::sqrt(std::max(0.0, (1.0 - cosine) / (1.0 + cosine)));
  return path.corners[i] * half_angle > 0.5 * std::min(before, after);
}

/// Moves points slightly where the limb bends more sharply than its thickness allows, since its
/// surface would fold there. Exports have such points where rings are close together and their
/// centres scatter.
void fair(LimbPath& path) {
  std::vector<glm::dvec3> first;
  for (int sweep = 0; sweep < kFairSweeps; ++sweep) {
    bool moved = false;
    for (size_t i = 1; i + 1 < path.points.size(); ++i) {
      if (!folds_at(path, i)) continue;
      if (first.empty()) first = path.points;
      const glm::dvec3 along = path.points[i + 1] - path.points[i - 1];
      const double square = glm::dot(along, along);
      if (square <= 0.0) continue;
      const double t = glm::dot(path.points[i] - path.points[i - 1], along) / square;
      const glm::dvec3 wanted =
          path.points[i - 1] + along * std::clamp(t, kFairMargin, 1.0 - kFairMargin);
      const glm::dvec3 vector = path.points[i] + (wanted - path.points[i]) * kFairStep - first[i];
      const double most = kFairStray * path.corners[i];
      const double length = glm::length(vector);
      path.points[i] = first[i] + (length > most ? vector * (most / length) : vector);
      moved = true;
    }
    if (!moved) return;
  }
}

/// Distance below which two joints are merged. Where the export's limb is thinner than the surface
/// can be, the surface has no room for joints closer than its thickness.
double closest_joint(double corner, double next, const LengthLimits& scale) {
  const bool thinnest = std::max(corner, next) <= scale.smallest_corner;
  return thinnest ? kThinnestJoints * scale.smallest_corner : scale.coincident;
}

}  // namespace

LengthLimits length_limits(const Skeleton& skeleton) {
  if (skeleton.branches.empty()) {
    throw std::invalid_argument("the skeleton has no branches");
  }
  glm::dvec3 low(1e300), high(-1e300);
  for (size_t b = 0; b < skeleton.branches.size(); ++b) {
    const Branch& branch = skeleton.branches[b];
    const size_t count = branch.points.size();
    if (count == 0 || branch.radii.size() != count || branch.areas.size() != count) {
      throw std::invalid_argument(
          "branch '" + branch.name +
          "' needs at least one point, and one radius and one area per point");
    }
    if (branch.parent >= static_cast<int32_t>(b) || branch.parent < -1) {
      throw std::invalid_argument("branch '" + branch.name + "' must come after its parent");
    }
    for (size_t i = 0; i < count; ++i) {
      if (!finite(branch.points[i]) || !std::isfinite(branch.areas[i]) || branch.areas[i] < 0.0f ||
          !std::isfinite(branch.radii[i]) || branch.radii[i] < 0.0f) {
        throw std::invalid_argument("branch '" + branch.name + "', point " + std::to_string(i) +
                                    ": position, radius or area is negative or not finite");
      }
      low = glm::min(low, glm::dvec3(branch.points[i]));
      high = glm::max(high, glm::dvec3(branch.points[i]));
    }
  }
  LengthLimits scale;
  scale.height = skeleton.height > 0.0f ? skeleton.height : high.z - low.z;
  // A tree that lies flat, or a skeleton far from upright, is measured by its extent instead.
  scale.height = std::max(scale.height, 0.1 * glm::length(high - low));
  if (scale.height <= 0.0) {
    scale.height = 1.0;
  }
  scale.coincident = 1e-6 * scale.height;
  scale.smallest_corner = 1.5 * kSmallestRadius * scale.height;
  scale.smallest_knuckle = 4.0 * kSmallestRadius * scale.height;
  scale.smallest_gap = kSmallestRadius * scale.height;
  return scale;
}

void measure(LimbPath& path) {
  path.lengths.assign(path.points.size(), 0.0);
  for (size_t i = 1; i < path.points.size(); ++i) {
    path.lengths[i] = path.lengths[i - 1] + glm::distance(path.points[i - 1], path.points[i]);
  }
}

int32_t segment_at(const std::vector<double>& lengths, double s) {
  const auto it = std::lower_bound(lengths.begin() + 1, lengths.end() - 1, s);
  return static_cast<int32_t>(it - lengths.begin()) - 1;
}

glm::dvec3 position_at(const LimbPath& path, double s) {
  const int32_t i = segment_at(path.lengths, s);
  const double t =
      std::clamp((s - path.lengths[i]) / (path.lengths[i + 1] - path.lengths[i]), 0.0, 1.0);
  return path.points[i] + (path.points[i + 1] - path.points[i]) * t;
}

double corner_at(const LimbPath& path, double s) {
  return lerp_at(path.lengths, path.corners, s);
}

double bone_length_at(const LimbPath& path, double s) {
  return lerp_at(path.lengths, path.bone_lengths, s);
}

glm::dvec3 direction_at(const LimbPath& path, double s) {
  const int32_t i = segment_at(path.lengths, s);
  return glm::normalize(path.points[i + 1] - path.points[i]);
}

double nearest_length(const LimbPath& path, const glm::dvec3& point) {
  Nearest nearest;
  for (size_t i = 0; i + 1 < path.points.size(); ++i) {
    nearest.try_segment(path, i, point);
  }
  return nearest.length;
}

double PathSearch::nearest_length(const glm::dvec3& point) const {
  const std::vector<StripTree::Node>& nodes = tree_.nodes();
  Nearest nearest;
  // Runs are halved at most 31 times, each leaving one entry.
  std::array<std::pair<double, int32_t>, 40> stack{};
  size_t count = 1;
  while (count > 0) {
    const auto [least, number] = stack[--count];
    const StripTree::Node& node = nodes[number];
    if (least > std::sqrt(nearest.square) + tree_.rounding()) {
      continue;
    }
    if (node.second == 0) {
      for (int32_t i = node.begin; i < node.end; ++i) {
        nearest.try_segment(path_, i, point);
      }
      continue;
    }
    std::pair near(tree_.least_distance(nodes[number + 1], point), number + 1);
    std::pair far(tree_.least_distance(nodes[node.second], point), node.second);
    if (far < near) {
      std::swap(near, far);
    }
    stack[count++] = far;
    stack[count++] = near;
  }
  return nearest.length;
}

std::vector<LimbPath> limb_paths(const Skeleton& skeleton, const Widths& widths,
                                 const LengthLimits& scale) {
  std::vector<LimbPath> paths(skeleton.branches.size());
  for (size_t b = 0; b < paths.size(); ++b) {
    const Branch& branch = skeleton.branches[b];
    LimbPath& path = paths[b];
    path.points.reserve(branch.points.size());
    path.corners.reserve(branch.points.size());
    for (size_t i = 0; i < branch.points.size(); ++i) {
      const glm::dvec3 point(branch.points[i]);
      const double corner =
          std::max(std::sqrt(0.5 * static_cast<double>(widths.areas[b][i])), scale.smallest_corner);
      if (!path.points.empty() && glm::distance(path.points.back(), point) <=
                                      closest_joint(path.corners.back(), corner, scale)) {
        // Of two coincident rings the wider one is kept.
        path.corners.back() = std::max(path.corners.back(), corner);
        continue;
      }
      path.points.push_back(point);
      path.corners.push_back(corner);
    }
    if (path.points.size() == 1) {
      const double length = std::max(path.corners[0], 10.0 * scale.smallest_knuckle);
      path.points.push_back(path.points[0] + away_from_parent(branch, paths, scale) * length);
      path.corners.push_back(path.corners[0]);
    }
    fair(path);
    measure(path);
    path.bone_lengths = path.lengths;
  }
  return paths;
}

}  // namespace snowbough::tree
