#include "tree/detail/forks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "tree/detail/creases.h"
#include "tree/detail/uncross.h"
#include "tree/detail/untangle.h"
#include "tree/mesh/neighbours.h"

namespace snowbough::tree {
namespace {

/// Rounds of following the neighbours and projecting to the surface, the fraction of the distance
/// that a vertex moves, and projection steps per round. Most vertices converge after a few; fewer
/// rounds would leave a notch in acute crotches, where vertices move far.
constexpr int kBlendRounds = 40;
constexpr double kRelaxation = 0.5;
constexpr int kSteps = 2;
/// Maximum length of a step, in radii of the child.
constexpr double kLongestStep = 0.5;
/// A vertex stops while it and its neighbours move less than this fraction of the longest step in a
/// round.
constexpr double kRest = 0.02;
/// Number of halvings of a step that would turn a face over before it is dropped; a face counts as
/// turned if less than this fraction of it is visible from outside.
constexpr int kHalvings = 3;
constexpr double kMinArea = 0.1;
/// Fraction of a fork's reach beyond which vertices do not move along the surface.
constexpr double kStill = 0.7;
/// When unfolding: maximum pulling distance in radii of the child, and projection steps.
constexpr double kPull = 0.25;
constexpr int kStepsBack = 1;
/// Maximum displacement when softening creases in the rows beside holes, in corner radii of the
/// limb: the middle of one of sixteen sides lies 0.02 inside.
constexpr double kBesideHole = 0.03;
/// Progress at which the forks are blended, and unfolded.
constexpr float kBlended = 0.5f;
constexpr float kSpreadOut = 0.8f;
/// Maximum number of forks that affect a vertex: the nearest ones, relative to their reach.
constexpr size_t kMaxForks = 4;
/// Vertices per thread at a time.
constexpr size_t kActiveBlock = 256;

/// A vertex that moves, and the forks that affect it.
struct Mover {
  int32_t vertex = -1;
  int32_t first_fork = 0, last_fork = 0;
  /// Its relaxation along the surface, and its projection step.
  double relaxation = 0.0;
  double longest_step = 0.0;
};

class ForkBlender {
 public:
  ForkBlender(const Surface& surface, const std::vector<Fork>& forks,
              const std::vector<int32_t>& chains, const FineMesh& fine,
              std::vector<glm::dvec3>& points)
      : surface_(surface),
        fine_(fine),
        points_(points),
        first_points_(points),
        chains_(chains),
        forks_(forks),
        neighbours_(fine.quads, fine.vertices.size()),
        mover_of_(points.size(), -1) {
    find_movers();
  }

  void blend(const base::Execution& execution) {
    std::vector<glm::dvec3> moved(movers_.size());
    std::vector<int32_t> active(movers_.size());
    std::iota(active.begin(), active.end(), 0);
    for (int round = 0; round < kBlendRounds && !active.empty(); ++round) {
      const float from = kBlended * static_cast<float>(round) / kBlendRounds;
      const float to = kBlended * static_cast<float>(round + 1) / kBlendRounds;
      base::parallel_for(active.size(), kActiveBlock, execution.part(from, to),
                         [&](size_t begin, size_t end) {
                           for (size_t i = begin; i < end; ++i) {
                             moved[active[i]] = move(movers_[active[i]]);
                           }
                         });
      move_active(moved, active);
    }
    const MovedFaces moved_faces = collect_moved();
    MovedCrossings crossings(moved_faces);
    spread_out(crossings, execution.part(kBlended, kSpreadOut));
    std::vector<double> farthest = beside_holes();
    for (const Mover& mover : movers_) farthest[mover.vertex] = mover.longest_step;
    soften_creases(fine_, surface_.origins, chains_, farthest, points_);
    undo_moves(crossings, first_points_, execution.part(kSpreadOut, 1.0f), points_);
  }

 private:
  void spread_out(MovedCrossings& crossings, const base::Execution& execution) {
    std::vector<double> pull(points_.size(), 0.0);
    for (const Mover& mover : movers_) {
      if (mover.relaxation > 0.0) pull[mover.vertex] = kPull / kLongestStep * mover.longest_step;
    }
    const auto onto = [this](int32_t vertex, const glm::dvec3& p) {
      return onto_surface(movers_[mover_of_[vertex]], p, kStepsBack).first;
    };
    untangle(crossings, pull, onto, execution, points_);
  }

  /// Per vertex its maximum displacement in the rows beside holes: where a hole nearly fills its
  /// row, the remaining strip is so short that the middle of a side, which lies inside the next
  /// row's corners, makes a step.
  std::vector<double> beside_holes() const {
    std::vector<std::vector<double>> of_rows(surface_.limbs.size());
    for (const Junction& junction : surface_.junctions) {
      const std::vector<Ring>& rings = surface_.limbs[junction.parent].rings;
      std::vector<double>& rows = of_rows[junction.parent];
      rows.resize(rings.size(), 0.0);
      for (int row = std::max(junction.row - 1, 0); row <= junction.row + 1; ++row) {
        if (row < static_cast<int>(rings.size())) rows[row] = kBesideHole * rings[row].corner;
      }
    }
    std::vector<double> farthest(points_.size(), 0.0);
    for (size_t f = 0; f < fine_.quads.size(); ++f) {
      const FaceOrigin& origin = surface_.origins[fine_.face[f]];
      const std::vector<double>& rows = of_rows[origin.branch];
      if (origin.part != FacePart::kWall || rows.empty()) continue;
      for (const int32_t v : fine_.quads[f]) farthest[v] = std::max(farthest[v], rows[origin.row]);
    }
    return farthest;
  }

  /// Moves the active vertices; those that moved, or whose neighbours moved, stay active.
  void move_active(const std::vector<glm::dvec3>& moved, std::vector<int32_t>& active) {
    std::vector<uint8_t> is_active(movers_.size(), 0);
    for (const int32_t i : active) {
      const int32_t v = movers_[i].vertex;
      if (glm::distance(points_[v], moved[i]) > kRest * movers_[i].longest_step) {
        is_active[i] = 1;
        for (const int32_t neighbour : neighbours_.of(v)) {
          if (mover_of_[neighbour] >= 0) is_active[mover_of_[neighbour]] = 1;
        }
      }
      points_[v] = moved[i];
    }
    active.clear();
    for (size_t i = 0; i < movers_.size(); ++i) {
      if (is_active[i] != 0) active.push_back(static_cast<int32_t>(i));
    }
  }

  /// Caps stay flat, and the rings around them stay in place.
  std::vector<uint8_t> capped() const {
    std::vector<uint8_t> cap(points_.size(), 0);
    for (size_t f = 0; f < fine_.quads.size(); ++f) {
      const FacePart part = surface_.origins[fine_.face[f]].part;
      if (part == FacePart::kTipCap || part == FacePart::kRootCap) {
        for (const int32_t v : fine_.quads[f]) cap[v] = 1;
      }
    }
    return cap;
  }

  /// Finds all vertices within the fork's reach, starting from the collar of every child's hole.
  void find_movers() {
    const std::vector<uint8_t> fixed = capped();
    // Vertex, distance from a fork in its reaches, and the fork.
    std::vector<std::tuple<int32_t, double, int32_t>> pairs;
    std::vector<int32_t> met(points_.size(), -1), queue;
    for (size_t j = 0; j < forks_.size(); ++j) {
      const Fork& fork = forks_[j];
      if (!fork.blends) continue;
      const auto meet = [&](int32_t v) {
        if (met[v] != static_cast<int32_t>(j) &&
            glm::distance(points_[v], fork.centre) < fork.reach) {
          met[v] = static_cast<int32_t>(j);
          queue.push_back(v);
        }
      };
      queue.clear();
      for (const int32_t v : surface_.limbs[surface_.junctions[j].child].rings[0].vertices) {
        meet(v);
      }
      for (size_t i = 0; i < queue.size(); ++i) {
        for (const int32_t v : neighbours_.of(queue[i])) meet(v);
      }
      for (const int32_t v : queue) {
        if (fixed[v] != 0) continue;
        pairs.emplace_back(v, glm::distance(points_[v], fork.centre) / fork.reach,
                           static_cast<int32_t>(j));
      }
    }
    std::sort(pairs.begin(), pairs.end());
    for (size_t i = 0; i < pairs.size();) {
      Mover mover;
      mover.vertex = std::get<0>(pairs[i]);
      mover.first_fork = static_cast<int32_t>(at_.size());
      const int32_t own = chains_[surface_.origins[fine_.vertices[mover.vertex].face].branch];
      bool known = false;
      for (size_t met = 0; i < pairs.size() && std::get<0>(pairs[i]) == mover.vertex; ++i, ++met) {
        if (met >= kMaxForks) continue;
        const auto [vertex, away, number] = pairs[i];
        const Fork& fork = forks_[number];
        at_.push_back(number);
        known |= fork.parent_chain == own || fork.child_chain == own;
        const double share = std::clamp((1.0 - away) / (1.0 - kStill), 0.0, 1.0);
        mover.relaxation = std::max(mover.relaxation, kRelaxation * share);
        mover.longest_step = std::max(mover.longest_step, kLongestStep * fork.radius);
      }
      mover.last_fork = static_cast<int32_t>(at_.size());
      // On a limb that begins only further out, the vertex keeps that limb's own surface.
      if (!known) continue;
      mover_of_[mover.vertex] = static_cast<int32_t>(movers_.size());
      movers_.push_back(mover);
    }
  }

  MovedFaces collect_moved() const {
    MovedFaces moved{fine_.quads, neighbours_, {}, {}, {}, {}};
    for (const Mover& mover : movers_) moved.moving.push_back(mover.vertex);
    for (size_t f = 0; f < fine_.quads.size(); ++f) {
      const Quad& quad = fine_.quads[f];
      if (std::any_of(quad.begin(), quad.end(), [&](int32_t v) { return mover_of_[v] >= 0; })) {
        moved.faces.push_back(static_cast<int32_t>(f));
      }
    }
    for (const int32_t face : fine_.face) {
      moved.chains.push_back(chains_[surface_.origins[face].branch]);
    }
    moved.parents.assign(chains_.size(), -1);
    for (const Fork& fork : forks_) moved.parents[fork.child_chain] = fork.parent_chain;
    return moved;
  }

  std::span<const int32_t> forks_of(const Mover& mover) const {
    return {at_.data() + mover.first_fork, at_.data() + mover.last_fork};
  }

  glm::dvec3 move(const Mover& mover) const {
    glm::dvec3 p = points_[mover.vertex];
    if (mover.relaxation > 0.0) {
      // Vertices follow their neighbours, weighted by proximity: their initial distances are right.
      const glm::dvec3& from = first_points_[mover.vertex];
      glm::dvec3 sum(0.0);
      double weights = 0.0;
      for (const int32_t v : neighbours_.of(mover.vertex)) {
        const double weight = 1.0 / std::max(glm::distance(first_points_[v], from), 1e-30);
        sum += (points_[v] - first_points_[v]) * weight;
        weights += weight;
      }
      const glm::dvec3 offset = from + sum / weights - p;
      const glm::dvec3 normal = blended_distance(p, forks_of(mover), forks_).gradient;
      p += (offset - normal * glm::dot(offset, normal)) * mover.relaxation;
    }
    glm::dvec3 outwards;
    std::tie(p, outwards) = onto_surface(mover, p, kSteps);
    const glm::dvec3& old = points_[mover.vertex];
    for (int half = 0; half < kHalvings; ++half) {
      if (!folds(mover.vertex, p, outwards)) return p;
      p = 0.5 * (p + old);
    }
    return old;
  }

  /// Result of some steps from p towards the blended surface, and the outward direction there.
  std::pair<glm::dvec3, glm::dvec3> onto_surface(const Mover& mover, glm::dvec3 p,
                                                 int steps) const {
    FieldValue field;
    for (int step = 0; step < steps; ++step) {
      field = blended_distance(p, forks_of(mover), forks_);
      p -= field.gradient * std::clamp(field.distance, -mover.longest_step, mover.longest_step);
    }
    return {p, field.gradient};
  }

  /// Whether moving a vertex to p would turn a face around it over.
  bool folds(int32_t vertex, const glm::dvec3& p, const glm::dvec3& outwards) const {
    const glm::dvec3& old = points_[vertex];
    for (int32_t i = neighbours_.begin[vertex]; i < neighbours_.begin[vertex + 1]; ++i) {
      const glm::dvec3& after = points_[neighbours_.all[i]];
      const glm::dvec3& before = points_[neighbours_.before[i]];
      const glm::dvec3 then = glm::cross(after - p, before - p);
      const glm::dvec3 now = glm::cross(after - old, before - old);
      const double least = kMinArea * std::min(glm::length(now), glm::length(then));
      if (glm::dot(then, outwards) < least && glm::dot(now, outwards) >= least) return true;
      if (glm::dot(then, now) <= 0.0) return true;
    }
    return false;
  }

  const Surface& surface_;
  const FineMesh& fine_;
  std::vector<glm::dvec3>& points_;
  /// Initial positions.
  const std::vector<glm::dvec3> first_points_;
  const std::vector<int32_t>& chains_;
  const std::vector<Fork>& forks_;
  Neighbours neighbours_;
  std::vector<Mover> movers_;
  /// Per vertex: its mover, or -1.
  std::vector<int32_t> mover_of_;
  /// The forks of all movers, in order of the movers.
  std::vector<int32_t> at_;
};

}  // namespace

void blend_forks(const Surface& surface, const std::vector<Fork>& forks,
                 const std::vector<int32_t>& chains, const FineMesh& fine,
                 const base::Execution& execution, std::vector<glm::dvec3>& points) {
  ForkBlender(surface, forks, chains, fine, points).blend(execution);
}

}  // namespace snowbough::tree
