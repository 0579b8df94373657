#include "tree/detail/forks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>
#include <utility>

#include "tree/crossings/whole.h"

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
/// What crosses goes back by this factor, entirely once less than the least share is left, in at
/// most so many rounds; with its neighbours, which keep at most so much more of their ways.
constexpr double kBack = 0.6;
constexpr double kLeastShare = 0.15;
constexpr int kBackRounds = 8;
constexpr double kShareStep = 0.34;
/// What still crosses is put between its neighbours by this share of the way, in at most so many
/// rounds.
constexpr double kUntangling = 0.5;
constexpr int kUntangleRounds = 12;
/// Share of the time until everything is blended, and until what that made cross has gone back.
constexpr float kBlended = 0.6f;
constexpr float kTakenBack = 0.9f;
/// Forks that a thread looks at at a time.
constexpr size_t kForkBlock = 8;
/// Vertices that a thread moves at a time.
constexpr size_t kBlock = 256;

/// The vertices around every vertex, those of each in flat arrays, ascending.
struct Neighbours {
  std::vector<int32_t> begin, all;
  /// The vertex before, in the face in which that in `all` comes after.
  std::vector<int32_t> before;

  Neighbours(const std::vector<Quad>& quads, size_t count) : begin(count + 1, 0) {
    // Every edge is met from both its faces, once in either direction.
    for (const Quad& quad : quads) {
      for (const int32_t v : quad) ++begin[v + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    all.resize(begin.back());
    before.resize(begin.back());
    std::vector<int32_t> next(begin.begin(), begin.end() - 1);
    for (const Quad& quad : quads) {
      for (int k = 0; k < 4; ++k) {
        before[next[quad[k]]] = quad[(k + 3) % 4];
        all[next[quad[k]]++] = quad[(k + 1) % 4];
      }
    }
  }
  std::span<const int32_t> of(int32_t v) const {
    return {all.data() + begin[v], all.data() + begin[v + 1]};
  }
};

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
    take_back_crossings(execution.part(kBlended, kTakenBack));
    untangle(execution.part(kTakenBack, 1.0f));
  }

 private:
  /// Moves the active vertices, and leaves those active that go on: they or neighbours have moved.
  void take_ways(const std::vector<glm::dvec3>& moved, std::vector<int32_t>& active) {
    std::vector<uint8_t> awake(movers_.size(), 0);
    for (const int32_t i : active) {
      const int32_t v = movers_[i].vertex;
      if (glm::distance(points_[v], moved[i]) > kRest * movers_[i].longest_step) {
        awake[i] = 1;
        for (const int32_t neighbour : neighbours_.of(v)) {
          if (mover_of_[neighbour] >= 0) awake[mover_of_[neighbour]] = 1;
        }
      }
      points_[v] = moved[i];
    }
    active.clear();
    for (size_t i = 0; i < movers_.size(); ++i) {
      if (awake[i] != 0) active.push_back(static_cast<int32_t>(i));
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

  /// Per fork that is due: pairs of its faces that cross and did not at first.
  std::vector<std::vector<std::pair<int32_t, int32_t>>> new_crossings(
      const std::vector<std::vector<int32_t>>& faces, const std::vector<uint8_t>& due,
      const base::Execution& execution) const {
    const Surface now{points_, fine_.quads, {}, {}, {}, {}, {}};
    const Surface first{first_points_, fine_.quads, {}, {}, {}, {}, {}};
    std::vector<std::vector<std::pair<int32_t, int32_t>>> found(forks_.size());
    base::parallel_for(forks_.size(), kForkBlock, execution, [&](size_t begin, size_t end) {
      for (size_t j = begin; j < end; ++j) {
        if (due[j] == 0) continue;
        found[j] = crossing_quads(now, faces[j]);
        if (found[j].empty()) continue;
        const auto before = crossing_quads(first, faces[j]);
        std::erase_if(found[j], [&](const auto& pair) {
          return std::binary_search(before.begin(), before.end(), pair);
        });
      }
    });
    return found;
  }

  void take_back_crossings(const base::Execution& execution) {
    const std::vector<std::vector<int32_t>> faces = fork_faces();
    const std::vector<glm::dvec3> blended(points_);
    // Share of its way that every vertex goes.
    std::vector<double> shares(points_.size(), 1.0);
    std::vector<uint8_t> due(forks_.size(), 1);
    for (int round = 0; round < kBackRounds; ++round) {
      const float from = static_cast<float>(round) / kBackRounds;
      const float to = static_cast<float>(round + 1) / kBackRounds;
      const auto found = new_crossings(faces, due, execution.part(from, to));
      std::vector<double> wanted(shares);
      bool crosses = false;
      for (const auto& pairs : found) {
        for (const auto& [f, g] : pairs) {
          for (const int32_t face : {f, g}) {
            for (const int32_t v : fine_.quads[face]) {
              const bool gone = round + 2 >= kBackRounds || shares[v] < kLeastShare;
              wanted[v] = gone ? 0.0 : kBack * shares[v];
              crosses = true;
            }
          }
        }
      }
      if (!crosses) return;
      even_out(wanted);
      std::fill(due.begin(), due.end(), uint8_t{0});
      for (const Mover& mover : movers_) {
        const int32_t v = mover.vertex;
        if (wanted[v] == shares[v]) continue;
        points_[v] = first_points_[v] + (blended[v] - first_points_[v]) * wanted[v];
        for (const int32_t fork : forks_of(mover)) due[fork] = 1;
      }
      shares = std::move(wanted);
    }
  }

  /// Smooths what crosses in a fork, and what is beside it, until nothing does; where it still does
  /// in the end, as much or more, it stays as it was.
  void untangle(const base::Execution& execution) {
    const std::vector<std::vector<int32_t>> faces = fork_faces();
    std::vector<size_t> tangled;
    std::vector<std::vector<std::pair<int32_t, int32_t>>> found(forks_.size());
    base::parallel_for(forks_.size(), kForkBlock, execution, [&](size_t begin, size_t end) {
      const Surface now{points_, fine_.quads, {}, {}, {}, {}, {}};
      for (size_t j = begin; j < end; ++j) found[j] = crossing_quads(now, faces[j]);
    });
    for (size_t j = 0; j < forks_.size(); ++j) {
      if (!found[j].empty()) untangle(faces[j], found[j]);
    }
  }

  void untangle(const std::vector<int32_t>& faces,
                std::vector<std::pair<int32_t, int32_t>> crossing) {
    Surface now{points_, fine_.quads, {}, {}, {}, {}, {}};
    std::vector<std::pair<int32_t, glm::dvec3>> before;
    const size_t at_first = crossing.size();
    for (int round = 0; round < kUntangleRounds && !crossing.empty(); ++round) {
      std::vector<int32_t> vertices;
      for (const auto& [f, g] : crossing) {
        for (const int32_t face : {f, g}) {
          for (const int32_t v : fine_.quads[face]) {
            vertices.push_back(v);
            vertices.insert(vertices.end(), neighbours_.of(v).begin(), neighbours_.of(v).end());
          }
        }
      }
      std::sort(vertices.begin(), vertices.end());
      vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
      std::erase_if(vertices, [&](int32_t v) { return mover_of_[v] < 0; });
      std::vector<glm::dvec3> moved;
      for (const int32_t v : vertices) {
        before.emplace_back(v, now.vertices[v]);
        glm::dvec3 sum(0.0);
        for (const int32_t other : neighbours_.of(v)) sum += now.vertices[other];
        sum /= static_cast<double>(neighbours_.of(v).size());
        moved.push_back(now.vertices[v] + (sum - now.vertices[v]) * kUntangling);
      }
      for (size_t i = 0; i < vertices.size(); ++i) now.vertices[vertices[i]] = moved[i];
      crossing = crossing_quads(now, faces);
    }
    if (crossing.size() < at_first) {
      for (const auto& [v, place] : before) points_[v] = now.vertices[v];
    }
  }

  /// Neighbours' shares differ by no more than kShareStep.
  void even_out(std::vector<double>& shares) const {
    for (int pass = 0; pass < 3; ++pass) {
      for (const Mover& mover : movers_) {
        double& share = shares[mover.vertex];
        for (const int32_t v : neighbours_.of(mover.vertex)) {
          share = std::min(share, shares[v] + kShareStep);
        }
      }
    }
  }

  glm::dvec3 move(const Mover& mover) const {
    const std::span<const int32_t> at(at_.data() + mover.first_fork, at_.data() + mover.last_fork);
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
      const glm::dvec3 normal = blended_distance(p, at, forks_).gradient;
      p += (way - normal * glm::dot(way, normal)) * mover.relaxation;
    }
    FieldValue field;
    for (int step = 0; step < kSteps; ++step) {
      field = blended_distance(p, at, forks_);
      p -= field.gradient * std::clamp(field.distance, -mover.longest_step, mover.longest_step);
    }
    const glm::dvec3& old = points_[mover.vertex];
    for (int half = 0; half < kHalvings; ++half) {
      if (!folds(mover.vertex, p, field.gradient)) return p;
      p = 0.5 * (p + old);
    }
    return old;
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
