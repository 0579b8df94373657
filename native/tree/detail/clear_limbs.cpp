#include "tree/detail/clear_limbs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>
#include <utility>

#include "base/group_by_key.h"
#include "tree/crossings/whole.h"
#include "tree/detail/uncross.h"
#include "tree/mesh/neighbours.h"

namespace snowbough::tree {
namespace {

/// Maximum number of rounds of searching and repairing.
constexpr int kRounds = 10;
/// In the first rounds only the thinner of two limbs is bent; then both, since one may be stuck
/// between two others.
constexpr int kThinnerOnly = 4;
/// Rounds in which faces move back to the base.
constexpr int kBackRounds = 5;
/// If more pairs per face than this intersect, the input is not a tree; skip repair.
constexpr double kMaxPairsPerFace = 0.01;
/// A limb is bent by its depth in the other limb plus a fraction of both radii; the maximum per
/// round in the same unit; and the minimum length of the bend, as a multiple of the displacement
/// and in radii.
constexpr double kSpare = 0.06;
constexpr double kMaxAtATime = 1.0;
constexpr double kStretchOfMove = 8.0;
constexpr double kStretchOfRadius = 4.0;
/// For longer faces: the length as a multiple of the nearest vertex's distance.
constexpr double kStretch = 2.0;
/// Number of edges around intersecting faces that move back to the base.
constexpr int kBackRings = 2;
constexpr double kBackReach = 3.0;

using Pairs = std::vector<std::pair<int32_t, int32_t>>;

/// The closest approach of two limbs relative to their thickness.
struct Approach {
  glm::dvec3 on_first{0.0}, on_second{0.0};
  double first_radius = 0.0, second_radius = 0.0;
  double clearance = 1e300;
};

double radius_of(const LimbPath& path, size_t i, double t) {
  const double corner = path.corners[i] * (1.0 - t) + path.corners[i + 1] * t;
  return corner * std::sqrt(2.0 / M_PI);
}

/// Fractions of two segments, from p and q on, at their closest points.
///
/// Source: C. Ericson, "Real-Time Collision Detection", 2005, section 5.1.9.
std::pair<double, double> nearest_shares(const glm::dvec3& p, const glm::dvec3& along_p,
                                         const glm::dvec3& q, const glm::dvec3& along_q) {
  const glm::dvec3 off = p - q;
  const double a = glm::dot(along_p, along_p), b = glm::dot(along_p, along_q);
  const double e = glm::dot(along_q, along_q);
  const double c = glm::dot(along_p, off), f = glm::dot(along_q, off);
  const double determinant = a * e - b * b;
  double s =
      determinant > 1e-12 * a * e ? std::clamp((b * f - c * e) / determinant, 0.0, 1.0) : 0.0;
  const double t = std::clamp((b * s + f) / e, 0.0, 1.0);
  s = std::clamp((b * t - c) / a, 0.0, 1.0);
  return {s, t};
}

Approach nearest_approach(const LimbPath& first, const LimbPath& second) {
  Approach nearest;
  for (size_t i = 0; i + 1 < first.points.size(); ++i) {
    for (size_t j = 0; j + 1 < second.points.size(); ++j) {
      const glm::dvec3 p = first.points[i], along_p = first.points[i + 1] - p;
      const glm::dvec3 q = second.points[j], along_q = second.points[j + 1] - q;
      const auto [s, t] = nearest_shares(p, along_p, q, along_q);
      Approach here;
      here.on_first = p + along_p * s;
      here.on_second = q + along_q * t;
      here.first_radius = radius_of(first, i, s);
      here.second_radius = radius_of(second, j, t);
      here.clearance =
          glm::distance(here.on_first, here.on_second) - here.first_radius - here.second_radius;
      if (here.clearance < nearest.clearance) nearest = here;
    }
  }
  return nearest;
}

/// Two intersecting limbs, and the intersecting faces of each.
struct CrossingLimbs {
  int32_t first = -1, second = -1;
  std::vector<int32_t> first_faces, second_faces;
};

class Clearer {
 public:
  Clearer(const Surface& surface, const std::vector<LimbPath>& paths,
          const std::vector<int32_t>& parents, const std::vector<int32_t>& chains,
          const FineMesh& fine, std::vector<glm::dvec3>& points)
      : surface_(surface),
        paths_(paths),
        parents_(parents),
        chains_(chains),
        fine_(fine),
        points_(points) {}

  void clear(const base::Execution& execution) {
    std::vector<int32_t> all(fine_.quads.size());
    std::iota(all.begin(), all.end(), 0);
    // Faces that have not moved since the last round need no check.
    std::vector<uint8_t> changed;
    for (int round = 0; round < kRounds; ++round) {
      base::report_progress(execution.progress, static_cast<float>(round) / kRounds);
      const Pairs crossing = crossing_quads(points_, fine_.quads, all, changed, execution.threads);
      const std::vector<glm::dvec3> before(points_);
      for (const CrossingLimbs& limbs : unrelated_limbs(crossing))
        separate(limbs, round >= kThinnerOnly);
      if (static_cast<double>(crossing.size()) > kMaxPairsPerFace * static_cast<double>(all.size()))
        return;
      if (round < kBackRounds) {
        to_base(related(crossing), kBackReach * std::exp2(round), execution);
      }
      changed = changed_faces(before);
      if (changed.empty()) return;
      straighten(fine_, changed, points_);
    }
  }

 private:
  int32_t branch(int32_t face) const { return surface_.origins[fine_.face[face]].branch; }

  /// Whether two limbs are the same or one leaves the other.
  bool are_related(int32_t a, int32_t b) const {
    const auto parent_chain = [&](int32_t limb) {
      const int32_t parent = parents_[chains_[limb]];
      return parent < 0 ? -1 : chains_[parent];
    };
    return chains_[a] == chains_[b] || parent_chain(a) == chains_[b] ||
           parent_chain(b) == chains_[a];
  }

  /// 1 per face with a moved corner; empty: none has moved.
  std::vector<uint8_t> changed_faces(const std::vector<glm::dvec3>& before) const {
    std::vector<uint8_t> changed(fine_.quads.size(), 0);
    bool any = false;
    for (size_t f = 0; f < changed.size(); ++f) {
      for (const int32_t v : fine_.quads[f]) {
        if (points_[v] != before[v]) changed[f] = 1;
      }
      any |= changed[f] != 0;
    }
    if (!any) changed.clear();
    return changed;
  }

  Pairs related(const Pairs& crossing) const {
    Pairs found;
    for (const auto& [f, g] : crossing) {
      if (are_related(branch(f), branch(g))) found.emplace_back(f, g);
    }
    return found;
  }

  /// Corner radius of the limb at a face's thicker end.
  double corner(int32_t face) const {
    const LimbSurface& limb = surface_.limbs[branch(face)];
    const auto row = static_cast<size_t>(surface_.origins[fine_.face[face]].row);
    const size_t next = std::min(row + 1, limb.rings.size() - 1);
    return std::max(limb.rings[row].corner, limb.rings[next].corner);
  }

  std::vector<CrossingLimbs> unrelated_limbs(const Pairs& crossing) const {
    std::vector<std::array<int32_t, 4>> sorted;
    for (const auto& [f, g] : crossing) {
      const int32_t a = branch(f), b = branch(g);
      if (are_related(a, b)) continue;
      sorted.push_back(a < b ? std::array{a, b, f, g} : std::array{b, a, g, f});
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<CrossingLimbs> found;
    for (const auto& [a, b, f, g] : sorted) {
      if (found.empty() || found.back().first != a || found.back().second != b) {
        found.push_back({a, b, {}, {}});
      }
      found.back().first_faces.push_back(f);
      found.back().second_faces.push_back(g);
    }
    return found;
  }

  /// Minimum or maximum extent of faces along a direction.
  double reach(const std::vector<int32_t>& faces, const glm::dvec3& along, double sign) const {
    double most = -1e300;
    for (const int32_t f : faces) {
      for (const int32_t v : fine_.quads[f]) {
        most = std::max(most, sign * glm::dot(points_[v], along));
      }
    }
    return sign * most;
  }

  /// Bends the thinner of two limbs away from the other one, unless they intersect in the export.
  void separate(const CrossingLimbs& limbs, bool both_bend) {
    const Approach near = nearest_approach(paths_[limbs.first], paths_[limbs.second]);
    if (near.clearance <= 0.0) return;
    const glm::dvec3 off = near.on_second - near.on_first;
    const glm::dvec3 direction = off / glm::length(off);
    const double both = near.first_radius + near.second_radius;
    const double inside =
        reach(limbs.first_faces, direction, 1.0) - reach(limbs.second_faces, direction, -1.0);
    const double move = std::clamp(inside, 0.0, kMaxAtATime * both) + kSpare * both;
    const bool first_bends = near.first_radius < near.second_radius;
    if (first_bends || both_bend) {
      bend(limbs.first, place_of(limbs.first_faces, near.on_first, both), -direction * move,
           near.first_radius);
    }
    if (!first_bends || both_bend) {
      bend(limbs.second, place_of(limbs.second_faces, near.on_second, both), direction * move,
           near.second_radius);
    }
  }

  /// A place, or the centre of some faces if the place is too far from them.
  glm::dvec3 place_of(const std::vector<int32_t>& faces, const glm::dvec3& place,
                      double distance) const {
    glm::dvec3 low(1e300), high(-1e300);
    for (const int32_t f : faces) {
      for (const int32_t v : fine_.quads[f]) {
        low = glm::min(low, points_[v]);
        high = glm::max(high, points_[v]);
      }
    }
    const glm::dvec3 nearest = glm::clamp(place, low, high);
    return glm::distance(nearest, place) <= distance ? place : 0.5 * (low + high);
  }

  /// Moves a limb's vertices around a place, less with distance.
  void bend(int32_t limb, const glm::dvec3& place, const glm::dvec3& move, double radius) {
    const double stretch =
        std::max(kStretchOfMove * glm::length(move), kStretchOfRadius * radius) + radius;
    if (first_faces_.empty()) number_faces();
    std::vector<int32_t> vertices;
    for (size_t i = first_faces_[limb]; i < first_faces_[limb + 1]; ++i) {
      for (const int32_t v : fine_.quads[by_limb_[i]]) vertices.push_back(v);
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    double nearest = 1e300;
    for (const int32_t v : vertices) {
      // Vertices between others follow these.
      if (between_[v] == 0) nearest = std::min(nearest, glm::distance(points_[v], place));
    }
    const double farthest = stretch + kStretch * nearest;
    for (const int32_t v : vertices) {
      const double share = std::min(1.0, glm::distance(points_[v], place) / farthest);
      const double left = 1.0 - share * share;
      points_[v] += move * (left * left);
    }
  }

  /// Collects the faces of every limb, and the vertices between others.
  void number_faces() {
    const auto for_faces = [&](const auto& visit) {
      const auto faces = static_cast<int32_t>(fine_.quads.size());
      for (int32_t f = 0; f < faces; ++f) visit(branch(f), f);
    };
    base::group_by_key(surface_.limbs.size(), for_faces, first_faces_, by_limb_);
    between_ = between_others(fine_);
  }

  /// Moves intersecting faces and their surroundings back towards the base.
  /// @param radii  range around them, in corner radii of the thicker limb.
  void to_base(const Pairs& crossing, double radii, const base::Execution& execution) {
    if (crossing.empty()) return;
    if (!neighbours_) neighbours_.emplace(fine_.quads, fine_.vertices.size());
    // Per vertex that moves back: the range in which others do, from the limb's thickness there.
    std::vector<double> near(points_.size(), 0.0);
    const auto take_beside = [&](int32_t face, int32_t other, double reach) {
      for (const int32_t v : fine_.quads[face]) {
        if (is_beside(v, other, reach)) near[v] = std::max(near[v], reach);
      }
    };
    for (const auto& [f, g] : crossing) {
      const double reach = radii * std::max(corner(f), corner(g));
      take_beside(f, g, reach);
      take_beside(g, f, reach);
    }
    MovedFaces around{fine_.quads, *neighbours_, {}, {}, {}, {-1}};
    around.chains.assign(fine_.quads.size(), 0);
    for (int ring = 0; ring < kBackRings; ++ring) {
      const std::vector<double> inner(near);
      for (size_t v = 0; v < inner.size(); ++v) {
        if (inner[v] <= 0.0) continue;
        for (const int32_t beside : neighbours_->of(static_cast<int32_t>(v))) {
          if (glm::distance(points_[v], points_[beside]) <= inner[v]) {
            near[beside] = std::max(near[beside], inner[v]);
          }
        }
      }
    }
    std::vector<glm::dvec3> base(points_);
    for (size_t v = 0; v < near.size(); ++v) {
      if (near[v] <= 0.0) continue;
      around.moving.push_back(static_cast<int32_t>(v));
      base[v] = on_base(fine_.vertices[v]);
    }
    for (size_t f = 0; f < fine_.quads.size(); ++f) {
      const Quad& quad = fine_.quads[f];
      if (std::any_of(quad.begin(), quad.end(), [&](int32_t v) { return near[v] > 0.0; })) {
        around.faces.push_back(static_cast<int32_t>(f));
      }
    }
    MovedCrossings crossings(around);
    tree::undo_moves(crossings, base, execution, points_);
  }

  /// Whether a corner of a face is within `distance` of a vertex: the other end of a long face may
  /// be far from its intersection.
  bool is_beside(int32_t vertex, int32_t face, double distance) const {
    const Quad& quad = fine_.quads[face];
    return std::any_of(quad.begin(), quad.end(), [&](int32_t v) {
      return glm::distance(points_[v], points_[vertex]) <= distance;
    });
  }

  glm::dvec3 on_base(const FinePlace& at) const {
    const Quad& quad = surface_.quads[at.face];
    const auto& p = surface_.vertices;
    return (p[quad[0]] * (1.0 - at.u) + p[quad[1]] * at.u) * (1.0 - at.v) +
           (p[quad[3]] * (1.0 - at.u) + p[quad[2]] * at.u) * at.v;
  }

  const Surface& surface_;
  const std::vector<LimbPath>& paths_;
  const std::vector<int32_t>& parents_;
  const std::vector<int32_t>& chains_;
  const FineMesh& fine_;
  std::vector<glm::dvec3>& points_;
  /// Created on first use: most trees need neither.
  std::optional<Neighbours> neighbours_;
  std::vector<size_t> first_faces_;
  std::vector<int32_t> by_limb_;
  std::vector<uint8_t> between_;
};

}  // namespace

void clear_limbs(const Surface& surface, const std::vector<LimbPath>& paths,
                 const std::vector<int32_t>& parents, const std::vector<int32_t>& chains,
                 const FineMesh& fine, const base::Execution& execution,
                 std::vector<glm::dvec3>& points) {
  Clearer(surface, paths, parents, chains, fine, points).clear(execution);
}

}  // namespace snowbough::tree
