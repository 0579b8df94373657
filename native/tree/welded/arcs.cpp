#include "tree/welded/arcs.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace snowbough::tree {
namespace {

/// Maximum distance of a limb along its parent from their fork, in the sum of both radii.
constexpr double kAttachReach = 4.0;
/// At a fork thickness is weighted by this power of (1 + cosine of the turn) / 2.
constexpr double kStraightness = 4.0;
/// Ratio of reaches at which a limb without a heading continues along the farther one.
constexpr double kFarther = 1.5;
/// Minimum distance of a limb's tip from the parent's centreline, in the parent's radii.
constexpr double kStandsOut = 1.5;
/// Number of rings after a fork whose median gives the thickness of a limb.
constexpr size_t kThicknessRings = 5;

/// Joins arcs to limbs.
class Assembler {
 public:
  Assembler(const ReebTree& tree, std::vector<ArcRings> rings, const LocalMesh& mesh,
            const std::vector<double>& distance, const std::vector<int32_t>& root)
      : tree_(tree),
        rings_(std::move(rings)),
        tips_(tree.arcs.size(), -1),
        limb_of_(tree.arcs.size(), 0) {
    for (size_t v = 0; v < distance.size(); ++v) {
      const int32_t arc = tree.arc_of[v];
      if (arc < 0 || !std::isinf(tree.bump_from[v])) continue;
      int32_t& tip = tips_[arc];
      if (tip < 0 || distance[v] > distance[tip]) tip = static_cast<int32_t>(v);
    }
    mesh_ = &mesh;
    for (const int32_t v : root) root_ += glm::dvec3(mesh.positions[v]);
    root_ /= static_cast<double>(root.size());
  }

  WeldedTree assemble() {
    struct Start {
      int32_t arc, parent;
      /// Last point of the parent before the fork.
      size_t fork;
    };
    std::vector<Start> starts{{static_cast<int32_t>(tree_.arcs.size()) - 1, -1, 0}};
    for (size_t s = 0; s < starts.size(); ++s) {
      const auto [first, parent, fork] = starts[s];
      Limb limb;
      std::vector<std::pair<int32_t, size_t>> leaving;
      std::vector<int32_t> arcs;
      for (int32_t arc = first; arc >= 0;) {
        arcs.push_back(arc);
        for (const Contour& ring : rings_[arc].contours) append(ring, limb);
        const std::vector<int32_t>& above = tree_.arcs[arc].above;
        if (above.empty()) {
          append_tip(arc, limb);
          break;
        }
        const int32_t next = continuing(above, limb);
        for (const int32_t other : above) {
          if (other != next) {
            leaving.emplace_back(other, limb.points.empty() ? 0 : limb.points.size() - 1);
          }
        }
        arc = next;
      }
      const bool lies =
          parent >= 0 && leaving.empty() && lies_on(limb, result_.limbs[parent], fork);
      const auto number = static_cast<int32_t>(result_.limbs.size());
      for (const int32_t arc : arcs) limb_of_[arc] = lies ? parent : number;
      if (lies) continue;
      if (parent < 0) {
        prepend(root_, limb);
        for (auto& [arc, at] : leaving) ++at;
        result_.attach_point.push_back(limb.points.front());
      } else {
        const glm::dvec3 foot = find_foot(limb, result_.limbs[parent], fork);
        prepend(foot, limb);
        for (auto& [arc, at] : leaving) ++at;
        result_.attach_point.emplace_back(foot);
      }
      result_.parent.push_back(parent);
      result_.limbs.push_back(std::move(limb));
      for (const auto& [arc, at] : leaving) starts.push_back({arc, number, at});
    }
    // Vertices out of reach belong to the first limb.
    for (const int32_t arc : tree_.arc_of) {
      result_.vertex_limb.push_back(arc >= 0 ? limb_of_[arc] : 0);
    }
    return std::move(result_);
  }

 private:
  static void append(const Contour& ring, Limb& limb) {
    if (!(ring.length > 0.0)) return;
    limb.points.emplace_back(ring.centre);
    limb.radii.push_back(static_cast<float>(ring.radius));
    limb.areas.push_back(static_cast<float>(ring.area));
  }

  /// Extends the limb to `place`, with the thickness of its first ring.
  static void prepend(const glm::dvec3& place, Limb& limb) {
    const float radius = limb.radii.empty() ? 0.0f : limb.radii.front();
    const float area = limb.areas.empty() ? 0.0f : limb.areas.front();
    limb.points.insert(limb.points.begin(), glm::vec3(place));
    limb.radii.insert(limb.radii.begin(), radius);
    limb.areas.insert(limb.areas.begin(), area);
  }

  /// Adds the tip straight on from the last two rings, at the distance of the farthest vertex.
  void append_tip(int32_t arc, Limb& limb) const {
    if (tips_[arc] < 0) return;
    const glm::dvec3 farthest(mesh_->positions[tips_[arc]]);
    if (limb.points.size() < 2) {
      limb.points.emplace_back(farthest);
    } else {
      const glm::dvec3 last(limb.points.back());
      const glm::dvec3 along = direction(glm::dvec3(limb.points[limb.points.size() - 2]), last);
      const double ahead = glm::dot(farthest - last, along);
      if (ahead <= 0.0) return;
      limb.points.emplace_back(last + along * ahead);
    }
    // A cone's last ring is half as far from its tip as the ring before it.
    const size_t count = limb.radii.size();
    const float taper =
        count >= 2 ? limb.radii[count - 1] / std::max(limb.radii[count - 2], 1e-30f) : 1.0f;
    const float share = taper > 0.75f ? taper : 0.0f;
    limb.radii.push_back(count > 0 ? share * limb.radii.back() : 0.0f);
    limb.areas.push_back(count > 0 ? share * share * limb.areas.back() : 0.0f);
  }

  const ArcRings* rings_from(int32_t arc) const {
    while (rings_[arc].empty() && !tree_.arcs[arc].above.empty())
      arc = tree_.arcs[arc].above.front();
    return rings_[arc].empty() ? nullptr : &rings_[arc];
  }

  /// Farthest distance on an arc and all that grows from it.
  double reach_of(int32_t arc) const {
    double reach = tree_.arcs[arc].end;
    for (const int32_t next : tree_.arcs[arc].above) reach = std::max(reach, reach_of(next));
    return reach;
  }

  /// Whether one arc reaches much farther than the others; `best` receives it.
  bool reaches_farthest(const std::vector<int32_t>& above, int32_t& best) const {
    double most = 0.0;
    double second = 0.0;
    for (const int32_t arc : above) {
      const double reach = reach_of(arc);
      if (reach > most) {
        second = most;
        most = reach;
        best = arc;
      } else {
        second = std::max(second, reach);
      }
    }
    return most >= kFarther * second;
  }

  /// The arc that continues the limb.
  int32_t continuing(const std::vector<int32_t>& above, const Limb& limb) const {
    const size_t count = limb.points.size();
    // The rings nearest to the fork lean towards the child.
    const glm::dvec3 heading =
        count >= 3   ? direction(glm::dvec3(limb.points[count - std::min<size_t>(count, 5)]),
                                 glm::dvec3(limb.points[count - 2]))
        : count == 2 ? direction(glm::dvec3(limb.points[0]), glm::dvec3(limb.points[1]))
                     : glm::dvec3(0.0);
    int32_t best = above.front();
    // Above roots the limb begins without a heading: its crown reaches much farther than they do.
    if (count == 0 && reaches_farthest(above, best)) return best;
    best = above.front();
    double best_score = -std::numeric_limits<double>::infinity();
    for (const int32_t arc : above) {
      const ArcRings* rings = rings_from(arc);
      if (rings == nullptr) continue;
      const std::vector<Contour>& contours = rings->contours;
      const size_t last = contours.size() - 1;
      const glm::dvec3 along = last >= 1 ? direction(contours[std::min<size_t>(1, last - 1)].centre,
                                                     contours[std::min<size_t>(4, last)].centre)
                               : count > 0
                                   ? direction(glm::dvec3(limb.points.back()), contours[0].centre)
                                   : glm::dvec3(0.0);
      std::vector<double> areas;
      for (size_t i = 0; i < std::min(kThicknessRings, contours.size()); ++i) {
        areas.push_back(contours[i].area);
      }
      std::nth_element(areas.begin(), areas.begin() + static_cast<ptrdiff_t>(areas.size() / 2),
                       areas.end());
      const double straight = 0.5 + 0.5 * glm::dot(heading, along);
      const double score =
          std::sqrt(areas[areas.size() / 2] / M_PI) * std::pow(straight, kStraightness);
      if (score > best_score) {
        best_score = score;
        best = arc;
      }
    }
    return best;
  }

  /// Calls `visit(i)` for the segments within some metres before and after point `at`.
  template <typename Visit>
  static void for_segments_near(const Limb& limb, size_t at, double before, double after,
                                const Visit& visit) {
    double walked = 0.0;
    for (size_t i = at; i > 0 && walked <= before; --i) {
      visit(i - 1);
      walked += glm::distance(limb.points[i], limb.points[i - 1]);
    }
    walked = 0.0;
    for (size_t i = at; i + 1 < limb.points.size() && walked <= after; ++i) {
      visit(i);
      walked += glm::distance(limb.points[i], limb.points[i + 1]);
    }
  }

  /// Whether an arc without forks ends within its parent: the distance rises unevenly there,
  /// without a limb.
  static bool lies_on(const Limb& limb, const Limb& parent, size_t fork) {
    const size_t at = std::min(fork + 1, parent.points.size() - 1);
    const glm::dvec3 tip(limb.points.back());
    const double reach = kAttachReach * static_cast<double>(parent.radii[at]);
    bool lies = false;
    for_segments_near(parent, at, reach, reach, [&](size_t i) {
      const glm::dvec3 a(parent.points[i]);
      const glm::dvec3 ab = glm::dvec3(parent.points[i + 1]) - a;
      const double square = glm::dot(ab, ab);
      const double t = square > 0.0 ? std::clamp(glm::dot(tip - a, ab) / square, 0.0, 1.0) : 0.0;
      const double radius = static_cast<double>(std::max(parent.radii[i], parent.radii[i + 1]));
      lies = lies || glm::distance(tip, a + ab * t) < kStandsOut * radius;
    });
    return lies;
  }

  /// The point of the parent's centreline nearest to the limb's backward extension.
  static glm::dvec3 find_foot(const Limb& limb, const Limb& parent, size_t fork) {
    const size_t at = std::min(fork + 1, parent.points.size() - 1);
    if (limb.points.empty()) return glm::dvec3(parent.points[at]);
    const glm::dvec3 from(limb.points.front());
    const size_t ahead = std::min<size_t>(2, limb.points.size() - 1);
    const glm::dvec3 back = -direction(from, glm::dvec3(limb.points[ahead]));
    const double reach =
        kAttachReach * (static_cast<double>(parent.radii[at]) + static_cast<double>(limb.radii[0]));
    glm::dvec3 best(parent.points[at]);
    double best_distance = std::numeric_limits<double>::infinity();
    const auto try_segment = [&](size_t i) {
      const glm::dvec3 a(parent.points[i]);
      const glm::dvec3 ab = glm::dvec3(parent.points[i + 1]) - a;
      // Nearest places of the segment and the ray: first of the lines, then clamped to both.
      const double aa = glm::dot(ab, ab);
      if (aa <= 0.0) return;
      const double cross = glm::dot(ab, back);
      const glm::dvec3 w = a - from;
      const double parallel = aa - cross * cross;
      double s = parallel > 1e-9 * aa ? (cross * glm::dot(w, back) - glm::dot(w, ab)) / parallel
                                      : -glm::dot(w, ab) / aa;
      s = std::clamp(s, 0.0, 1.0);
      const double t = std::max(0.0, glm::dot(a + ab * s - from, back));
      s = std::clamp(glm::dot(from + back * t - a, ab) / aa, 0.0, 1.0);
      const glm::dvec3 place = a + ab * s;
      const double distance = glm::distance(place, from + back * t);
      if (distance < best_distance) {
        best_distance = distance;
        best = place;
      }
    };
    for_segments_near(parent, at, reach, 0.25 * reach, try_segment);
    return best;
  }

  const ReebTree& tree_;
  std::vector<ArcRings> rings_;
  const LocalMesh* mesh_ = nullptr;
  /// Per arc: its farthest vertex.
  std::vector<int32_t> tips_;
  std::vector<int32_t> limb_of_;
  glm::dvec3 root_{0.0};
  WeldedTree result_;
};

}  // namespace

WeldedTree assemble_limbs(const ReebTree& tree, std::vector<ArcRings> rings, const LocalMesh& mesh,
                          const std::vector<double>& distance, const std::vector<int32_t>& root) {
  return Assembler(tree, std::move(rings), mesh, distance, root).assemble();
}

}  // namespace snowbough::tree
