#include "tree/collars/collars.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

/// Difference between two equal distances and their smooth minimum, relative to its width.
constexpr double kFilletHeight = 0.25;
/// Maximum number of steps towards the line, minimum length of a step, and tolerance; in radii of
/// the child's base.
constexpr int kMaxRaySteps = 60;
constexpr double kShortestStep = 0.03;
constexpr double kNear = 2e-3;
/// Minimum jump between a collar's points, in the same radii.
constexpr double kJump = 0.35;
/// Search window for a collar's place on the parent, in reaches of the fork.
constexpr double kWindow = 2.0;
/// Maximum length along which a child's side that begins outside its parent is followed, in the
/// same radii.
constexpr double kOutside = 2.0;
/// Where both limbs separate at a flat angle, the line between them may lie anywhere within this
/// many radii inside or outside of the parent.
constexpr double kDeepest = 0.1;
constexpr double kHighest = 0.3;
/// Maximum distance of its beginning inwards from the base's, in radii.
constexpr double kInwards = 1.2;
/// Relaxation passes per point of a collar, times the number of points: a collar that is fixed at
/// its ends converges as a whole.
constexpr size_t kStretches = 2;

/// One of the child's straight sides, offset from it.
class Side {
 public:
  Side(const Fork& fork, const LimbTubes& tubes, double quarter)
      : fork_(fork), tubes_(tubes), quarter_(quarter) {}

  glm::dvec3 at(double length) const {
    const glm::dvec3 p = tubes_.at(fork_.child_chain, {length, quarter_});
    const glm::dvec3 off = p - tubes_.centre(fork_.child_chain, length);
    const double radius = glm::length(off);
    const double height = kFilletHeight * fillet_width(fork_, p);
    return radius > 0.0 ? p + off * (height / radius) : p;
  }

  /// Height above the parent's surface, with the same offset.
  double above(const glm::dvec3& p) const {
    return fork_.from_parent(p).distance - kFilletHeight * fillet_width(fork_, p);
  }

  /// Arc length from which it stays `height` above the parent; if it was never below, at which it
  /// is closest.
  double rises_to(double height, double farthest) const {
    double length = -fork_.inside, nearest = length, least = 1e300;
    bool was_below = false;
    double below = length;
    for (int step = 0; step < kMaxRaySteps && length < farthest; ++step) {
      const double here = above(at(length)) - height;
      if (here < least) {
        least = here;
        nearest = length;
      }
      if (here < 0.0) {
        was_below = true;
        below = length;
        if (here > -kNear * fork_.radius) return length;
      } else if (was_below) {
        return between(below, length, height);
      } else if (length > -fork_.inside + kOutside * fork_.radius) {
        return nearest;
      }
      // The distance from a surface changes by no more than the step.
      length += std::max(std::abs(here), kShortestStep * fork_.radius);
    }
    return was_below ? farthest : nearest;
  }

 private:
  double between(double below, double beyond, double height) const {
    while (beyond - below > kNear * fork_.radius) {
      const double middle = 0.5 * (below + beyond);
      (above(at(middle)) < height ? below : beyond) = middle;
    }
    return beyond;
  }

  const Fork& fork_;
  const LimbTubes& tubes_;
  double quarter_;
};

/// Removes jumps from lengths around a collar, where sides graze the parent: replaces a value by
/// the median of it and its neighbours if that differs by more than `jump`.
void remove_jumps(double jump, std::vector<double>& lengths) {
  const size_t count = lengths.size();
  // A collar of eight points has only its own shape.
  for (size_t pass = 8; pass < 2 * count; pass *= 2) {
    const std::vector<double> from(lengths);
    for (size_t i = 0; i < count && count > 8; ++i) {
      const double a = from[(i + count - 1) % count], b = from[i], c = from[(i + 1) % count];
      const double median = std::max(std::min(a, b), std::min(std::max(a, b), c));
      if (std::abs(b - median) > jump) lengths[i] = median;
    }
  }
}

/// Pulls a collar tight like a string between its points' minimum and maximum lengths, so that it
/// has corners only where necessary.
void stretch(const std::vector<double>& least, const std::vector<double>& greatest,
             std::vector<double>& lengths) {
  const size_t count = lengths.size();
  for (size_t pass = 0; pass < kStretches * count; ++pass) {
    for (size_t i = 0; i < count; ++i) {
      // A length without its jump differs from its own side's.
      if (lengths[i] < least[i] || lengths[i] > greatest[i]) continue;
      const double middle = 0.5 * (lengths[(i + count - 1) % count] + lengths[(i + 1) % count]);
      lengths[i] = std::clamp(middle, least[i], greatest[i]);
    }
  }
}

/// Spaces a collar's points evenly along its line, with the smallest possible rotation around the
/// child.
void space_evenly(const Fork& fork, const LimbTubes& tubes, Collar& collar) {
  const size_t count = collar.size();
  std::vector<double> lengths(count + 1, 0.0);
  for (size_t i = 0; i < count; ++i) {
    lengths[i + 1] =
        lengths[i] + glm::distance(collar[i].position, collar[(i + 1) % count].position);
  }
  const double around = lengths[count];
  if (collar.empty() || around <= 0.0) return;
  double offset = 0.0;
  for (size_t i = 0; i < count; ++i) offset += lengths[i] / around - 0.25 * collar[i].quarter;
  offset /= static_cast<double>(count);
  const Collar from(collar);
  for (CollarPoint& point : collar) {
    const double share = 0.25 * point.quarter + offset;
    const double rounds = std::floor(share);
    const double place = (share - rounds) * around;
    const auto above = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, place);
    const auto low = static_cast<size_t>(above - lengths.begin()) - 1, high = (low + 1) % count;
    const double step = lengths[low + 1] - lengths[low];
    const double t = step > 0.0 ? (place - lengths[low]) / step : 0.0;
    const double next = from[high].quarter + (high == 0 ? 4.0 : 0.0);
    const double quarter = from[low].quarter * (1.0 - t) + next * t + 4.0 * rounds;
    point.turned = quarter - point.quarter;
    // Between equal lengths it is that length, to the bit.
    point.length = from[low].length + (from[high].length - from[low].length) * t;
    point.position = Side(fork, tubes, quarter).at(point.length);
  }
}

/// Arc length on the child next to a collar's point of the base.
double base_length(const Fork& fork, const LimbTubes& tubes, const CollarPoint& point) {
  const glm::dvec3 start = tubes.centre(fork.child_chain, 0.0);
  const glm::dvec3 axis = tubes.centre(fork.child_chain, fork.radius) - start;
  const glm::dvec3 off = tubes.at(fork.parent_chain, point.base) - start;
  return glm::dot(off, axis) / glm::length(axis);
}

}  // namespace

void meet_limbs(const Fork& fork, const LimbTubes& tubes, double farthest, Collar& collar) {
  std::vector<double> lengths, least, greatest;
  for (const CollarPoint& point : collar) {
    const Side side(fork, tubes, point.quarter);
    const double low = side.rises_to(-kDeepest * fork.radius, farthest);
    const double high = side.rises_to(kHighest * fork.radius, farthest);
    const double base = base_length(fork, tubes, point);
    const double inmost = std::min(base - kInwards * fork.radius, farthest);
    least.push_back(std::max(std::min(low, high), inmost));
    greatest.push_back(std::max(high, inmost));
    lengths.push_back(std::clamp(base, least.back(), greatest.back()));
  }
  remove_jumps(kJump * fork.radius, lengths);
  stretch(least, greatest, lengths);
  for (size_t i = 0; i < collar.size(); ++i) {
    collar[i].length = lengths[i];
    collar[i].position = Side(fork, tubes, collar[i].quarter).at(lengths[i]);
  }
  space_evenly(fork, tubes, collar);
  for (CollarPoint& point : collar) {
    point.target =
        tubes.nearest(fork.parent_chain, point.position, point.base, kWindow * fork.reach);
  }
}

}  // namespace snowbough::tree
