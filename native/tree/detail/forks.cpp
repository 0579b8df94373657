#include "tree/detail/forks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "tree/detail/creases.h"
#include "tree/detail/neighbours.h"
#include "tree/detail/uncross.h"
#include "tree/detail/untangle.h"

namespace snowbough::tree {
namespace {

/// Rounds of moving as the neighbours have moved and back to the surface, the share of the way that
/// a vertex goes, and steps back to the surface in each. Most vertices rest after a few; those in
/// acute crotches, which have far to go, would leave a notch there.
constexpr int kRounds = 40;
constexpr double kRelaxation = 0.5;
constexpr int kSteps = 2;
/// A step is no longer than this many of the child's radii.
constexpr double kLongestStep = 0.5;
/// A vertex rests while it and its neighbours go less than this share of the longest step in a
/// round.
constexpr double kRest = 0.02;
/// A way on which a face would turn its back is halved so often before it is given up; a face shows
/// its back when less than this share of it is seen from outside.
constexpr int kHalvings = 3;
constexpr double kLeastArea = 0.1;
/// Share of a fork's reach from which on vertices stay where they are along the surface.
constexpr double kStill = 0.7;
/// Where the mesh is spread out: edges longer than this many of the child's radii pull as if they
/// were as long, and steps back to the surface.
constexpr double kPull = 0.25;
constexpr int kStepsBack = 3;
/// Creases in the rows beside holes go away within this share of the limb's corner radius: the
/// middle of one of sixteen sides lies 0.02 of it inside.
constexpr double kBesideHole = 0.03;
/// Share of the time until everything is blended, and spread out.
constexpr float kBlended = 0.5f;
constexpr float kSpreadOut = 0.8f;
/// Vertices that a thread moves at a time.
constexpr size_t kBlock = 256;

/// A vertex that moves, and the forks that have a say in it.
struct Mover {
  int32_t vertex = -1;
  int32_t first_fork = 0, last_fork = 0;
  /// How far it goes along the surface, and how far off it at a time.
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
    for (int round = 0; round < kRounds && !active.empty(); ++round) {
      const float from = kBlended * static_cast<float>(round) / kRounds;
      const float to = kBlended * static_cast<float>(round + 1) / kRounds;
      base::parallel_for(active.size(), kBlock, execution.part(from, to),
                         [&](size_t begin, size_t end) {
                           for (size_t i = begin; i < end; ++i) {
                             moved[active[i]] = move(movers_[active[i]]);
                           }
                         });
      take_ways(moved, active);
    }
    ForkFaces moved_faces{fine_.quads, neighbours_, {}, fork_faces()};
    for (const Mover& mover : movers_) moved_faces.moving.push_back(mover.vertex);
    std::vector<uint8_t> dirty = spread_out(moved_faces, execution.part(kBlended, kSpreadOut));
    soften(moved_faces, dirty);
    uncross(moved_faces, first_points_, execution.part(kSpreadOut, 1.0f), points_,
            std::move(dirty));
  }

 private:
  /// Per fork, whether faces may cross still.
  std::vector<uint8_t> spread_out(const ForkFaces& moved_faces, const base::Execution& execution) {
    std::vector<double> pull(points_.size(), 0.0);
    for (const Mover& mover : movers_) {
      if (mover.relaxation > 0.0) pull[mover.vertex] = kPull / kLongestStep * mover.longest_step;
    }
    const auto onto = [this](int32_t vertex, const glm::dvec3& p) {
      return onto_surface(movers_[mover_of_[vertex]], p, kStepsBack).first;
    };
    return untangle(moved_faces, pull, onto, execution, points_);
  }

  /// Softens creases; in the forks where some were, faces may cross again.
  void soften(const ForkFaces& moved_faces, std::vector<uint8_t>& dirty) {
    std::vector<double> farthest = beside_holes();
    for (const Mover& mover : movers_) farthest[mover.vertex] = mover.longest_step;
    const std::vector<glm::dvec3> before(points_);
    soften_creases(fine_, surface_.origins, chains_, farthest, points_);
    for (size_t j = 0; j < dirty.size(); ++j) {
      const std::vector<int32_t>& faces = moved_faces.faces[j];
      dirty[j] |= std::any_of(faces.begin(), faces.end(), [&](int32_t face) {
        const Quad& quad = fine_.quads[face];
        return std::any_of(quad.begin(), quad.end(),
                           [&](int32_t v) { return points_[v] != before[v]; });
      });
    }
  }

  /// Per vertex how far it may go in the rows beside holes: where a hole nearly fills its row, what
  /// is left of them is so short that the middle of a side, which lies inside the next row's
  /// corners, makes a step.
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

  /// Moves the active vertices, and leaves those active that go on: they or neighbours have moved.
  void take_ways(const std::vector<glm::dvec3>& moved, std::vector<int32_t>& active) {
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

  /// Caps stay flat, and the rings around them where they are.
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

  /// From the rim of every child's hole on, all vertices within the fork's reach.
  void find_movers() {
    const std::vector<uint8_t> fixed = capped();
    std::vector<std::pair<int32_t, int32_t>> pairs;
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
        if (fixed[v] == 0) pairs.emplace_back(v, static_cast<int32_t>(j));
      }
    }
    std::sort(pairs.begin(), pairs.end());
    for (size_t i = 0; i < pairs.size();) {
      Mover mover;
      mover.vertex = pairs[i].first;
      mover.first_fork = static_cast<int32_t>(at_.size());
      const glm::dvec3& p = points_[mover.vertex];
      const int32_t own = chains_[surface_.origins[fine_.vertices[mover.vertex].face].branch];
      bool known = false;
      for (; i < pairs.size() && pairs[i].first == mover.vertex; ++i) {
        const Fork& fork = forks_[pairs[i].second];
        at_.push_back(pairs[i].second);
        known |= fork.parent_chain == own || fork.child_chain == own;
        const double away = glm::distance(p, fork.centre) / fork.reach;
        const double share = std::clamp((1.0 - away) / (1.0 - kStill), 0.0, 1.0);
        mover.relaxation = std::max(mover.relaxation, kRelaxation * share);
        mover.longest_step = std::max(mover.longest_step, kLongestStep * fork.radius);
      }
      mover.last_fork = static_cast<int32_t>(at_.size());
      // One on a limb that only begins further out keeps to that limb's own surface.
      if (!known) continue;
      mover_of_[mover.vertex] = static_cast<int32_t>(movers_.size());
      movers_.push_back(mover);
    }
  }

  /// Per fork: the faces that have vertices in it that move.
  std::vector<std::vector<int32_t>> fork_faces() const {
    std::vector<std::vector<int32_t>> faces(forks_.size());
    for (size_t f = 0; f < fine_.quads.size(); ++f) {
      const auto face = static_cast<int32_t>(f);
      for (const int32_t v : fine_.quads[f]) {
        if (mover_of_[v] < 0) continue;
        for (const int32_t fork : forks_of(movers_[mover_of_[v]])) {
          if (faces[fork].empty() || faces[fork].back() != face) faces[fork].push_back(face);
        }
      }
    }
    return faces;
  }

  std::span<const int32_t> forks_of(const Mover& mover) const {
    return {at_.data() + mover.first_fork, at_.data() + mover.last_fork};
  }

  glm::dvec3 move(const Mover& mover) const {
    glm::dvec3 p = points_[mover.vertex];
    if (mover.relaxation > 0.0) {
      // Vertices go where their neighbours go, the nearest most: how far apart they were at first
      // is as it should be.
      const glm::dvec3& from = first_points_[mover.vertex];
      glm::dvec3 sum(0.0);
      double weights = 0.0;
      for (const int32_t v : neighbours_.of(mover.vertex)) {
        const double weight = 1.0 / std::max(glm::distance(first_points_[v], from), 1e-30);
        sum += (points_[v] - first_points_[v]) * weight;
        weights += weight;
      }
      const glm::dvec3 way = from + sum / weights - p;
      const glm::dvec3 normal = blended_distance(p, forks_of(mover), forks_).gradient;
      p += (way - normal * glm::dot(way, normal)) * mover.relaxation;
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

  /// Where some steps from p towards the blended surface lead, and the direction out of it there.
  std::pair<glm::dvec3, glm::dvec3> onto_surface(const Mover& mover, glm::dvec3 p,
                                                 int steps) const {
    FieldValue field;
    for (int step = 0; step < steps; ++step) {
      field = blended_distance(p, forks_of(mover), forks_);
      p -= field.gradient * std::clamp(field.distance, -mover.longest_step, mover.longest_step);
    }
    return {p, field.gradient};
  }

  /// Whether a face around a vertex would turn its back where the vertex goes.
  bool folds(int32_t vertex, const glm::dvec3& p, const glm::dvec3& outwards) const {
    const glm::dvec3& old = points_[vertex];
    for (int32_t i = neighbours_.begin[vertex]; i < neighbours_.begin[vertex + 1]; ++i) {
      const glm::dvec3& after = points_[neighbours_.all[i]];
      const glm::dvec3& before = points_[neighbours_.before[i]];
      const glm::dvec3 then = glm::cross(after - p, before - p);
      const glm::dvec3 now = glm::cross(after - old, before - old);
      const double least = kLeastArea * std::min(glm::length(now), glm::length(then));
      if (glm::dot(then, outwards) < least && glm::dot(now, outwards) >= least) return true;
      if (glm::dot(then, now) <= 0.0) return true;
    }
    return false;
  }

  const Surface& surface_;
  const FineMesh& fine_;
  std::vector<glm::dvec3>& points_;
  /// Where they were at first.
  const std::vector<glm::dvec3> first_points_;
  const std::vector<int32_t>& chains_;
  const std::vector<Fork>& forks_;
  Neighbours neighbours_;
  std::vector<Mover> movers_;
  /// Per vertex: its mover, or -1.
  std::vector<int32_t> mover_of_;
  /// The forks of all movers, in their order.
  std::vector<int32_t> at_;
};

}  // namespace

void blend_forks(const Surface& surface, const std::vector<Fork>& forks,
                 const std::vector<int32_t>& chains, const FineMesh& fine,
                 const base::Execution& execution, std::vector<glm::dvec3>& points) {
  ForkBlender(surface, forks, chains, fine, points).blend(execution);
}

}  // namespace snowbough::tree
