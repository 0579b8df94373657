#include "tree/surface/crotch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

namespace snowbough::tree {
namespace {

/// Least radius of a second stem, as a fraction of its parent's, and cosine of its largest angle.
constexpr double kMinRadius = 0.5;
const double kMinCosine = std::sqrt(0.5);
/// The same as a fraction of the tree's height: where the tree fills a picture of a thousand
/// pixels, the crotch of a thinner limb is two pixels wide.
constexpr double kMinStem = 1e-3;
/// Greatest length of a crotch along the parent, and distance between samples, in the child's
/// radii.
constexpr double kLongest = 8.0;
constexpr double kStep = 0.25;
/// Length of the child, in the parent's radii, within which both limbs have to be apart.
constexpr double kFarthest = 40.0;

/// A stem leaves another stem if both separate this many times as far up as from their parent.
constexpr double kLater = 1.05;
/// A stem begins beside another stem within this many of that stem's radii.
constexpr double kBeside = 2.0;
/// Two limbs of which one is no stem leave their parent together if they begin within this many
/// radii, and separate this many times as far up as from their parent.
constexpr double kTogether = 1.0;
constexpr double kMuchLater = 1.3;
/// Joints closer than this to an added one are left out, in the limb's radii.
constexpr double kClosest = 0.5;
/// Samples across two circles.
constexpr int kChords = 64;

double radius_at(const LimbPath& path, double s) {
  return corner_at(path, s) * std::sqrt(2.0 / M_PI);
}

/// Two points of a child's surface at one place along it, away from its parent and towards it: the
/// nearest arc lengths on the parent, and the heights above its surface.
struct Sample {
  double child = 0.0;
  double outer_length = 0.0, outer = 0.0;
  double inner_length = 0.0, inner = 0.0;
  /// Distance between both surfaces on the line between the centrelines, negative inside.
  double apart = 0.0;
};

Sample sample_at(const PathSearch& search, const LimbPath& child, double s) {
  const LimbPath& parent = search.path();
  const glm::dvec3 p = position_at(child, s), along = direction_at(child, s);
  const double radius = radius_at(child, s);
  const double beside = search.nearest_length(p);
  const auto across = [&](const glm::dvec3& v) { return v - along * glm::dot(v, along); };
  glm::dvec3 outwards = across(p - position_at(parent, beside));
  // On the parent's centreline the child's course decides.
  if (glm::length(outwards) < kStep * radius) outwards = -across(direction_at(parent, beside));
  const double length = glm::length(outwards);
  if (length > 0.0) outwards *= radius / length;
  Sample sample;
  sample.child = s;
  sample.apart = glm::distance(p, position_at(parent, beside)) - radius - radius_at(parent, beside);
  const auto height = [&](const glm::dvec3& point, double& nearest) {
    nearest = search.nearest_length(point);
    return glm::distance(point, position_at(parent, nearest)) - radius_at(parent, nearest);
  };
  sample.outer = height(p + outwards, sample.outer_length);
  sample.inner = height(p - outwards, sample.inner_length);
  return sample;
}

/// The fraction of the way between two values at which zero lies.
double zero_between(double a, double b) {
  return b > a ? std::clamp(-a / (b - a), 0.0, 1.0) : 1.0;
}

double mix(double a, double b, double t) {
  return a + (b - a) * t;
}

/// Arc length at which a child is outside its parent.
double leaves_at(const PathSearch& search, const LimbPath& child) {
  const LimbPath& parent = search.path();
  double s = 0.0;
  while (s < child.length()) {
    const glm::dvec3 p = position_at(child, s);
    const double beside = search.nearest_length(p), radius = radius_at(child, s);
    const double apart =
        glm::distance(p, position_at(parent, beside)) - radius - radius_at(parent, beside);
    if (apart >= 0.0) break;
    s += std::max(-apart, kStep * radius) + kClosest * radius;
  }
  return std::min(s, child.length());
}

/// Whether a limb begins beside another one that is as thick.
bool leave_together(const LimbPath& limb, const LimbPath& other) {
  const double apart = glm::distance(limb.points[0], other.points[0]);
  const double radius = radius_at(other, apart);
  return apart <= kTogether * radius && radius_at(limb, apart) <= radius;
}

/// The circle with the area and the centroid of two circles together.
struct Circle {
  double middle = 0.0, radius = 0.0;
};

/// @param apart  distance of the other's centre.
Circle join_circles(double radius, double other, double apart) {
  const double low = std::min(-radius, apart - other), high = std::max(radius, apart + other);
  const double step = (high - low) / kChords;
  double area = 0.0, moment = 0.0;
  for (int i = 0; i < kChords; ++i) {
    const double x = low + (i + 0.5) * step, off = x - apart;
    const double square = std::max({radius * radius - x * x, other * other - off * off, 0.0});
    area += 2.0 * std::sqrt(square) * step;
    moment += 2.0 * std::sqrt(square) * step * x;
  }
  return {moment / area, std::sqrt(area / M_PI)};
}

/// Gives a limb the area of its own and of a stem beside it, from where the stem rises to its heel.
void join_stem(const LimbPath& stem, const Crotch& crotch, LimbPath& limb) {
  LimbPath joined;
  const auto add = [&](double s, bool with_stem) {
    glm::dvec3 p = position_at(limb, s);
    double corner = corner_at(limb, s);
    if (with_stem) {
      const double beside = nearest_length(stem, p);
      const glm::dvec3 to = position_at(stem, beside) - p;
      const double apart = glm::length(to), radius = radius_at(limb, s);
      const Circle both = join_circles(radius, radius_at(stem, beside), apart);
      if (apart > 0.0) p += to * (both.middle / apart);
      corner *= both.radius / radius;
    }
    joined.points.push_back(p);
    joined.corners.push_back(corner);
    joined.bone_lengths.push_back(bone_length_at(limb, s));
  };
  const std::array<double, 3> added = {crotch.parent_rise, crotch.parent_heel, crotch.parent_end};
  size_t next = 0;
  for (size_t i = 0; i < limb.points.size(); ++i) {
    const double s = limb.lengths[i];
    while (next < added.size() && added[next] <= s) {
      if (added[next] > 0.0 && added[next] < limb.length()) add(added[next], next == 1);
      ++next;
    }
    const bool is_end = i == 0 || i + 1 == limb.points.size();
    const bool is_close = std::any_of(added.begin(), added.end(), [&](double place) {
      return std::abs(place - s) < kClosest * radius_at(limb, s);
    });
    if (is_end || !is_close) add(s, s > crotch.parent_rise && s <= crotch.parent_heel);
  }
  limb = std::move(joined);
  measure(limb);
}

}  // namespace

std::optional<Crotch> find_crotch(const PathSearch& search, double attach, const LimbPath& child,
                                  const LengthLimits& scale) {
  const LimbPath& parent = search.path();
  const double thick = radius_at(parent, attach);
  const double farthest = std::min(child.length(), kFarthest * thick);
  const double least = std::max(kMinRadius * thick, kMinStem * scale.height);
  const double widest = *std::max_element(child.corners.begin(), child.corners.end());
  if (widest * std::sqrt(2.0 / M_PI) < least) return std::nullopt;
  std::vector<Sample> samples{sample_at(search, child, 0.0)};
  if (samples[0].apart >= 0.0) return std::nullopt;
  double own = radius_at(child, 0.0);
  while (samples.back().apart < 0.0) {
    const double before = samples.back().child;
    if (before >= farthest) return std::nullopt;
    const double radius = radius_at(child, before);
    own = std::max(own, radius);
    // A limb may begin without width.
    const double step = kStep * std::max(radius, least);
    samples.push_back(sample_at(search, child, std::min(before + step, farthest)));
  }
  if (own < least) return std::nullopt;

  Crotch crotch;
  crotch.child_end = samples.back().child;
  crotch.parent_end = samples.back().inner_length;
  for (size_t i = samples.size() - 1; i > 0; --i) {
    const Sample& a = samples[i - 1];
    const Sample& b = samples[i];
    if (a.inner >= 0.0) continue;
    const double t = zero_between(a.inner, b.inner);
    crotch.child_end = mix(a.child, b.child, t);
    crotch.parent_end = mix(a.inner_length, b.inner_length, t);
    break;
  }
  const double longest = kLongest * radius_at(child, crotch.child_end);
  crotch.child_heel = samples[0].child;
  crotch.parent_heel = crotch.parent_rise = samples[0].outer_length;
  bool has_risen = samples[0].outer >= 0.0;
  for (size_t i = 1; i < samples.size(); ++i) {
    const Sample& a = samples[i - 1];
    const Sample& b = samples[i];
    const bool early = crotch.parent_end - a.outer_length > longest;
    if (!early && a.outer >= 0.0) break;
    const double t = early || b.outer < 0.0 ? 1.0 : zero_between(a.outer, b.outer);
    crotch.child_heel = mix(a.child, b.child, t);
    crotch.parent_heel = mix(a.outer_length, b.outer_length, t);
    if (!has_risen) {
      const double rise = b.outer < 0.0 ? 1.0 : zero_between(a.outer, b.outer);
      crotch.parent_rise = mix(a.outer_length, b.outer_length, rise);
      has_risen = b.outer >= 0.0;
    }
  }
  if (crotch.parent_end <= crotch.parent_heel || crotch.child_end <= crotch.child_heel) {
    return std::nullopt;
  }
  const glm::dvec3 along =
      position_at(parent, crotch.parent_end) - position_at(parent, crotch.parent_heel);
  const glm::dvec3 course =
      position_at(child, crotch.child_end) - position_at(child, crotch.child_heel);
  if (glm::dot(along, course) <= kMinCosine * glm::length(along) * glm::length(course)) {
    return std::nullopt;
  }
  return crotch;
}

std::vector<int32_t> surface_parents(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                                     const LengthLimits& scale) {
  /// A child that separates from its parent at `end` metres along its own path.
  struct Stem {
    int32_t branch = -1;
    double end = 0.0;
  };
  std::vector<int32_t> parents;
  // Of each stem: where on its own path it leaves its parent.
  std::vector<double> heels(paths.size(), -1.0);
  std::vector<std::vector<Stem>> stems(paths.size());
  std::vector<std::optional<PathSearch>> searches(paths.size());
  for (size_t b = 0; b < paths.size(); ++b) {
    const auto branch = static_cast<int32_t>(b);
    int32_t parent = skeleton.branches[b].parent;
    const glm::dvec3 attach(skeleton.branches[b].attach_point);
    while (parent >= 0 && heels[parent] > 0.0 &&
           nearest_length(paths[parent], attach) < heels[parent]) {
      parent = parents[parent];
    }
    parents.push_back(parent);
    if (parent < 0) continue;
    std::optional<PathSearch>& search = searches[parent];
    if (!search) search.emplace(paths[parent]);
    const auto crotch = find_crotch(*search, search->nearest_length(attach), paths[b], scale);
    const double end = crotch ? crotch->child_end : leaves_at(*search, paths[b]);
    double latest = end;
    for (const Stem& other : stems[parent]) {
      const LimbPath& path = paths[other.branch];
      const bool are_stems = crotch && heels[other.branch] >= 0.0;
      if (!are_stems && !leave_together(paths[b], path)) continue;
      std::optional<PathSearch>& beside = searches[other.branch];
      if (!beside) beside.emplace(path);
      const double near = beside->nearest_length(attach);
      const double away = glm::distance(position_at(path, near), attach);
      if (away > (near > 0.0 ? kBeside : kLongest) * radius_at(path, near)) continue;
      const auto between = find_crotch(*beside, near, paths[b], scale);
      // The other stem must have left their parent by then.
      if (between && between->child_end > (are_stems ? kLater : kMuchLater) * latest &&
          between->parent_end > other.end) {
        latest = between->child_end;
        parents[b] = other.branch;
      }
    }
    if (crotch) heels[b] = crotch->child_heel;
    stems[parent].push_back({branch, end});
  }
  return parents;
}

std::vector<LimbPath> join_stems(const Skeleton& skeleton, std::vector<LimbPath> paths,
                                 const LengthLimits& scale) {
  const std::vector<int32_t> parents = surface_parents(skeleton, paths, scale);
  const auto crotch_of = [&](const PathSearch& search, int32_t stem) {
    const glm::dvec3 attach(skeleton.branches[stem].attach_point);
    return find_crotch(search, search.nearest_length(attach), paths[stem], scale);
  };
  std::vector<std::vector<int32_t>> children(paths.size());
  for (size_t b = 0; b < paths.size(); ++b) {
    if (parents[b] >= 0) children[parents[b]].push_back(static_cast<int32_t>(b));
  }
  // Stems join their parent together with what has joined them: parents come first.
  for (size_t limb = paths.size(); limb-- > 0;) {
    std::vector<std::pair<double, int32_t>> stems;
    if (children[limb].empty()) continue;
    const PathSearch own(paths[limb]);
    for (const int32_t child : children[limb]) {
      const auto crotch = crotch_of(own, child);
      if (crotch && crotch->parent_rise < crotch->parent_heel) {
        stems.emplace_back(-crotch->parent_heel, child);
      }
    }
    // The last one that leaves joins first: it shifts where the others leave.
    std::sort(stems.begin(), stems.end());
    for (const auto& [heel, stem] : stems) {
      const auto crotch = crotch_of(PathSearch(paths[limb]), stem);
      if (crotch) join_stem(paths[stem], *crotch, paths[limb]);
    }
  }
  return paths;
}

}  // namespace snowbough::tree
