#include "tree/collars/unrolled_limbs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>
#include <utility>

#include "base/parallel_for.h"
#include "tree/mesh/neighbours.h"

namespace snowbough::tree {
namespace {

/// Range of the movement around a collar: a multiple of its farthest point's displacement, plus a
/// number of the hole's radii.
constexpr double kReachOfMove = 2.5;
constexpr double kReachOfFork = 2.0;
/// Neighbours farther than the collar's own edge length, or this many radii of the hole, pull as if
/// they were closer: faces beside the collar become as long as the fillet needs.
constexpr double kSpread = 0.5;
/// Vertices are attracted to their place, with the square of the distance relative to the collar's
/// reach: hardly beside the collar, where they must move, and at the reach as strongly as by a
/// neighbour at this fraction of it. Without this, the whole limb would rotate with the collar.
constexpr double kFade = 0.4;
/// Maximum number of iterations of the solver, and the square of the residual's fraction that it
/// leaves.
constexpr int kIterations = 100;
constexpr double kResidual = 1e-8;
/// Number of attempts for collars that are held back, and the least part of the way that the next
/// one is worth.
constexpr int kAttempts = 6;
constexpr double kMinStep = 0.015;
/// Minimum area of a face relative to its first.
constexpr double kMinArea = 0.04;
/// Displacements at turned faces are multiplied by kBack per round; in later rounds than
/// kBackRounds they are undone. The remaining shares of neighbours differ by at most kShareStep.
constexpr double kBack = 0.7;
constexpr int kBackRounds = 12;
constexpr double kShareStep = 0.5;
/// Chains per thread at a time.
constexpr size_t kBlock = 4;

/// Difference between two places on the same limb, the short way around.
glm::dvec2 difference(const TubePlace& from, const TubePlace& to) {
  const double quarters = to.quarter - from.quarter;
  return {std::abs(quarters) <= 2.0 ? quarters : quarters - 4.0 * std::round(quarters / 4.0),
          to.length - from.length};
}

/// Range around a hole in which vertices move, in metres on the unrolled parent.
struct CollarReach {
  int32_t junction = -1;
  TubePlace centre;
  double radius = 0.0;
  double quarter_length = 1.0;
  /// Length of the faces beside the collar that the fillet needs.
  double spread = 0.0;
  /// Maximum lead of a point over the collar's slowest, as a fraction of the farthest point's way:
  /// half of the hole, otherwise the hole would turn inside out.
  double lead = 0.0;
  /// Mean share of the way that its points have gone.
  double gone = 0.0;

  double metres(const glm::dvec2& offset) const {
    return std::hypot(offset.x * quarter_length, offset.y);
  }
  double from_centre(const TubePlace& place) const { return metres(difference(centre, place)); }
};

CollarReach collar_reach(int32_t junction, const Collar& collar, const Fork& fork,
                         const LimbTubes& tubes) {
  glm::dvec2 middle(0.0);
  for (const CollarPoint& point : collar) middle += difference(collar[0].base, point.base);
  middle /= static_cast<double>(collar.size());
  CollarReach reach;
  reach.junction = junction;
  reach.centre = {collar[0].base.length + middle.y, collar[0].base.quarter + middle.x};
  reach.quarter_length = 0.5 * M_PI * tubes.radius(fork.parent_chain, reach.centre.length);
  double extent = 0.0, farthest = 0.0;
  for (const CollarPoint& point : collar) {
    farthest = std::max(farthest, reach.metres(difference(point.base, point.target)));
    extent = std::max({extent, reach.from_centre(point.base), reach.from_centre(point.target)});
  }
  reach.spread = std::min(kSpread, 2.0 * M_PI / static_cast<double>(collar.size())) * fork.radius;
  reach.lead = fork.radius / std::max(farthest, 1e-30);
  reach.radius = extent + kReachOfMove * farthest + kReachOfFork * fork.radius;
  return reach;
}

/// Divides a chain's collars into groups whose reaches overlap.
std::vector<std::span<const CollarReach>> apart(std::span<CollarReach> collars) {
  std::sort(collars.begin(), collars.end(), [](const CollarReach& a, const CollarReach& b) {
    const double low = a.centre.length - a.radius, other = b.centre.length - b.radius;
    return low != other ? low < other : a.junction < b.junction;
  });
  std::vector<std::span<const CollarReach>> parts;
  size_t first = 0;
  double end = -1e300;
  for (size_t i = 0; i < collars.size(); ++i) {
    if (i > first && collars[i].centre.length - collars[i].radius > end) {
      parts.push_back(collars.subspan(first, i - first));
      first = i;
    }
    end = std::max(end, collars[i].centre.length + collars[i].radius);
  }
  parts.push_back(collars.subspan(first));
  return parts;
}

/// The smaller of a face's two triangle areas, doubled.
double least_area(const std::array<TubePlace, 4>& corners) {
  const auto cross = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; };
  const glm::dvec2 a = difference(corners[0], corners[1]);
  const glm::dvec2 b = difference(corners[0], corners[2]);
  const glm::dvec2 c = difference(corners[0], corners[3]);
  return std::min(cross(a, b), cross(b, c));
}

/// Collars on one chain whose reaches overlap, and the vertices within their range.
class CollarGroup {
 public:
  /// @param local_of  per vertex -1; used for the group's own vertices.
  CollarGroup(const Neighbours& neighbours, const std::vector<Collar>& collars,
              std::span<const CollarReach> reaches, UnrolledLimbs& unrolled,
              std::vector<int32_t>& local_of)
      : neighbours_(neighbours), reaches_(reaches), unrolled_(unrolled), local_of_(local_of) {
    for (size_t j = 0; j < reaches.size(); ++j) add_collar(collars[reaches[j].junction], j);
    collar_count_ = nodes_.size();
    for (size_t j = 0; j < reaches.size(); ++j) add_free(collars[reaches[j].junction], j);
  }

  void move() {
    solve();
    hold_back();
    std::vector<TubePlace> places;
    for (const Node& node : nodes_) places.push_back(moved(node.vertex));
    for (size_t i = 0; i < nodes_.size(); ++i) {
      const Node& node = nodes_[i];
      unrolled_.places[node.vertex] = places[i];
      if (i < collar_count_) unrolled_.shares[node.vertex] = gone(node, node.share);
      local_of_[node.vertex] = -1;
    }
  }

 private:
  struct Node {
    int32_t vertex = -1;
    /// Its own or nearest collar: an index into reaches_.
    size_t reach = 0;
    /// Displacement to the solution, and the fraction of it that is kept.
    glm::dvec2 way{0.0};
    double share = 1.0;
  };

  Node& add(int32_t vertex, size_t reach) {
    local_of_[vertex] = static_cast<int32_t>(nodes_.size());
    return nodes_.emplace_back(Node{vertex, reach});
  }

  void add_collar(const Collar& collar, size_t reach) {
    for (const CollarPoint& point : collar) {
      const glm::dvec2 way = difference(unrolled_.places[point.vertex], point.target);
      const int32_t known = local_of_[point.vertex];
      // Halfway, between two holes without a part of the parent between them.
      if (known >= 0) nodes_[known].way = 0.5 * (nodes_[known].way + way);
      if (known < 0) add(point.vertex, reach).way = way;
    }
  }

  void add_free(const Collar& collar, size_t number) {
    const CollarReach& reach = reaches_[number];
    std::vector<int32_t> queue;
    for (const CollarPoint& point : collar) queue.push_back(point.vertex);
    for (size_t i = 0; i < queue.size(); ++i) {
      for (const int32_t v : neighbours_.of(queue[i])) {
        if (local_of_[v] >= 0 || unrolled_.fixed[v] != 0 ||
            reach.from_centre(unrolled_.places[v]) > reach.radius) {
          continue;
        }
        add(v, number);
        queue.push_back(v);
      }
    }
  }

  /// Solves Laplace's equation: a free vertex beside a collar lies at the weighted mean of its
  /// neighbours and of its own start; farther away it is displaced by the mean displacement of its
  /// neighbours. Both coordinates, around the limb and along it, are solved at once by conjugate
  /// gradients.
  void solve() {
    struct Link {
      int32_t node;
      double weight;
    };
    std::vector<Link> links;
    std::vector<size_t> first{0};
    std::vector<double> diagonal;
    std::vector<glm::dvec2> residual;
    for (size_t i = collar_count_; i < nodes_.size(); ++i) {
      const Node& node = nodes_[i];
      const CollarReach& reach = reaches_[node.reach];
      const TubePlace& place = unrolled_.places[node.vertex];
      const double away = std::min(reach.from_centre(place) / reach.radius, 1.0);
      // Beside the collar the neighbours' places count, farther away only their displacements, so
      // that rows keep their lengths.
      const double near = 1.0 - away;
      double sum = 0.0;
      glm::dvec2 force(0.0);
      for (const int32_t v : neighbours_.of(node.vertex)) {
        const glm::dvec2 offset = difference(place, unrolled_.places[v]);
        const double length = reach.metres(offset);
        const double weight = reach.spread / std::max(length, reach.spread);
        const double hold = length * away / (kFade * reach.radius);
        sum += weight * (1.0 + hold * hold);
        force += weight * near * near * near * offset;
        const int32_t other = local_of_[v];
        if (other < 0) continue;
        const auto at = static_cast<size_t>(other);
        if (at < collar_count_) force += weight * nodes_[at].way;
        if (at >= collar_count_)
          links.push_back({static_cast<int32_t>(at - collar_count_), weight});
      }
      first.push_back(links.size());
      diagonal.push_back(sum);
      residual.push_back(force);
    }
    const size_t count = diagonal.size();
    std::vector<glm::dvec2> direction(count), product(count);
    const auto dot = [&](const std::vector<glm::dvec2>& a, bool scaled) {
      glm::dvec2 sum(0.0);
      for (size_t i = 0; i < count; ++i) sum += a[i] * residual[i] / (scaled ? diagonal[i] : 1.0);
      return sum;
    };
    glm::dvec2 size(0.0), target(0.0);
    for (int round = 0; round < kIterations; ++round) {
      const glm::dvec2 now = dot(residual, true);
      if (round == 0) target = now * kResidual;
      if (now.x <= target.x && now.y <= target.y) return;
      const glm::dvec2 kept = round == 0 ? glm::dvec2(0.0) : now / glm::max(size, 1e-300);
      size = now;
      for (size_t i = 0; i < count; ++i) {
        direction[i] = residual[i] / diagonal[i] + direction[i] * kept;
      }
      glm::dvec2 along(0.0);
      for (size_t i = 0; i < count; ++i) {
        product[i] = direction[i] * diagonal[i];
        for (size_t k = first[i]; k < first[i + 1]; ++k) {
          product[i] -= direction[links[k].node] * links[k].weight;
        }
        along += product[i] * direction[i];
      }
      const glm::dvec2 step = size / glm::max(along, 1e-300);
      for (size_t i = 0; i < count; ++i) {
        nodes_[collar_count_ + i].way += direction[i] * step;
        residual[i] -= product[i] * step;
      }
    }
  }

  /// Fraction of a collar's whole way after `share` of the part that was left.
  double gone(const Node& node, double share) const {
    const double before = unrolled_.shares[node.vertex];
    return before + (1.0 - before) * share;
  }

  TubePlace moved(int32_t vertex) const {
    TubePlace place = unrolled_.places[vertex];
    if (local_of_[vertex] >= 0) {
      const Node& node = nodes_[local_of_[vertex]];
      place.quarter += node.way.x * node.share;
      place.length += node.way.y * node.share;
    }
    return place;
  }

  /// Moves the corners of turned faces back, and their neighbours less far, until no face is
  /// turned: at the latest when all are at their first place, where none is.
  void hold_back() {
    std::vector<uint8_t> changed(nodes_.size(), 1);
    for (int round = 0;; ++round) {
      std::vector<double> wanted;
      for (const Node& node : nodes_) wanted.push_back(node.share);
      bool any = false;
      for (size_t i = 0; i < nodes_.size(); ++i) {
        if (changed[i] == 0) continue;
        for (const int32_t f : neighbours_.faces_of(nodes_[i].vertex)) {
          const Quad& quad = unrolled_.quads[f];
          const bool known = std::any_of(quad.begin(), quad.end(), [&](int32_t v) {
            const auto at = static_cast<size_t>(local_of_[v]);
            return at < i && changed[at] != 0;
          });
          if (known || !turns(quad)) continue;
          any = true;
          for (const int32_t v : quad) {
            const int32_t at = local_of_[v];
            if (at >= 0) wanted[at] = round < kBackRounds ? kBack * nodes_[at].share : 0.0;
          }
        }
      }
      if (!any) return;
      limit_lead(wanted);
      for (int pass = 0; pass < 3; ++pass) {
        for (size_t i = 0; i < nodes_.size(); ++i) {
          for (const int32_t v : neighbours_.of(nodes_[i].vertex)) {
            const int32_t other = local_of_[v];
            if (other >= 0) wanted[i] = std::min(wanted[i], wanted[other] + kShareStep);
          }
        }
      }
      for (size_t i = 0; i < nodes_.size(); ++i) {
        changed[i] = nodes_[i].share != wanted[i];
        nodes_[i].share = wanted[i];
      }
    }
  }

  bool turns(const Quad& quad) const {
    std::array<TubePlace, 4> before, after;
    for (int k = 0; k < 4; ++k) {
      before[k] = unrolled_.places[quad[k]];
      after[k] = moved(quad[k]);
    }
    const double area = least_area(before);
    return least_area(after) < std::min(area, kMinArea * area);
  }

  /// Limits the lead of every collar's points over its slowest one.
  void limit_lead(std::vector<double>& shares) const {
    std::vector<double> slowest(reaches_.size(), 1.0);
    for (size_t i = 0; i < collar_count_; ++i) {
      double& least = slowest[nodes_[i].reach];
      least = std::min(least, gone(nodes_[i], shares[i]));
    }
    for (size_t i = 0; i < collar_count_; ++i) {
      const double before = unrolled_.shares[nodes_[i].vertex];
      const double most = slowest[nodes_[i].reach] + reaches_[nodes_[i].reach].lead;
      if (gone(nodes_[i], shares[i]) > most) {
        shares[i] = std::max((most - before) / (1.0 - before), 0.0);
      }
    }
  }

  const Neighbours& neighbours_;
  std::span<const CollarReach> reaches_;
  UnrolledLimbs& unrolled_;
  /// Per vertex: its node, or -1.
  std::vector<int32_t>& local_of_;
  /// The vertices of collars come first.
  std::vector<Node> nodes_;
  size_t collar_count_ = 0;
};

}  // namespace

void move_collars(const std::vector<Collar>& collars, const std::vector<Fork>& forks,
                  const LimbTubes& tubes, int threads, UnrolledLimbs& unrolled) {
  const Neighbours neighbours(unrolled.quads, unrolled.places.size());
  std::vector<std::pair<int32_t, int32_t>> by_chain;
  for (size_t j = 0; j < forks.size(); ++j) {
    if (forks[j].blends) by_chain.emplace_back(forks[j].parent_chain, static_cast<int32_t>(j));
  }
  std::sort(by_chain.begin(), by_chain.end());
  std::vector<CollarReach> reaches;
  std::vector<size_t> first;
  for (size_t i = 0; i < by_chain.size(); ++i) {
    const auto [chain, j] = by_chain[i];
    if (i == 0 || chain != by_chain[i - 1].first) first.push_back(i);
    reaches.push_back(collar_reach(j, collars[j], forks[j], tubes));
    for (const CollarPoint& point : collars[j]) unrolled.fixed[point.vertex] = 1;
  }
  first.push_back(by_chain.size());
  unrolled.shares.assign(unrolled.places.size(), 0.0);
  // Groups that move at the same time have no vertex in common.
  std::vector<int32_t> local_of(unrolled.places.size(), -1);
  base::parallel_for(first.size() - 1, kBlock, {threads, {}}, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      std::vector<CollarReach> behind(reaches.begin() + first[i], reaches.begin() + first[i + 1]);
      for (int attempt = 0; attempt < kAttempts && !behind.empty(); ++attempt) {
        for (const std::span<const CollarReach> collars_beside : apart(behind)) {
          CollarGroup(neighbours, collars, collars_beside, unrolled, local_of).move();
        }
        std::erase_if(behind, [&](CollarReach& reach) {
          double least = 1.0, sum = 0.0;
          for (const CollarPoint& point : collars[reach.junction]) {
            least = std::min(least, unrolled.shares[point.vertex]);
            sum +=
                unrolled.shares[point.vertex] / static_cast<double>(collars[reach.junction].size());
          }
          const double step = sum - std::exchange(reach.gone, sum);
          return least >= 1.0 || step < kMinStep;
        });
      }
    }
  });
}

}  // namespace snowbough::tree
