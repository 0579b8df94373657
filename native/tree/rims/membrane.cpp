#include "tree/rims/membrane.h"

#include <algorithm>
#include <glm/common.hpp>

#include "tree/rims/membrane_patch.h"

namespace snowbough::tree {
namespace {

/// Maximum length of a step relative to the faces beside the rim; maximum number of steps.
constexpr double kStep = 0.7;
constexpr int kMostSteps = 30;
/// Sweeps of the relaxation in the first step and in each later one, and its factor.
constexpr int kFirstSweeps = 25;
constexpr int kSweeps = 8;
constexpr double kOverRelaxation = 1.5;
/// Vertices that move with a rim are attracted to their place, with the square of the distance
/// relative to the rim's reach: hardly beside the rim, where they must make way, and at the reach
/// as strongly as by a neighbour at this fraction of it. Without this, the whole limb would rotate
/// with the rim up to the reach, and back within a single row.
constexpr double kFade = 0.25;
/// Initial sweeps that move vertices near a rim between their neighbours.
constexpr int kSpreads = 12;
/// Maximum lead in steps of a rim's vertex over the next.
constexpr int kMostAhead = 1;
/// Maximum number of times that rims are stopped within a step before turned faces are stopped
/// themselves.
constexpr int kMostHolds = 4;

/// Number of steps until the rims reach their targets.
int count_steps(std::span<const RimReach> rims) {
  double steps = 0.0;
  for (const RimReach& reach : rims) {
    steps = std::max(steps, reach.way / std::max(kStep * reach.spread, 1e-30));
  }
  return std::clamp(static_cast<int>(std::ceil(steps)), 0, kMostSteps);
}

/// A difference of quarters, the short way around.
double short_way(double quarters) {
  return std::abs(quarters) <= 2.0 ? quarters : quarters - 4.0 * std::round(quarters / 4.0);
}

/// Some rims on one chain during their movement.
class Membrane {
 public:
  Membrane(const Neighbours& neighbours, const std::vector<Rim>& rims,
           std::span<const RimReach> reaches, UnrolledLimbs& unrolled, Locals& locals)
      : neighbours_(neighbours),
        patch_(neighbours, rims, reaches, unrolled, locals),
        nodes_(patch_.nodes),
        rim_count_(patch_.rim_count),
        reaches_(reaches),
        steps_(count_steps(reaches)) {
    for (MembraneNode& node : nodes_) node.step /= std::max(steps_, 1);
  }

  /// Moves the rims as far as possible.
  void move(std::vector<double>& shares) {
    patch_.spread(kSpreads);
    for (int step = 0; step < steps_; ++step) {
      weigh();
      take_step(step == 0 ? kFirstSweeps : kSweeps);
    }
    for (size_t i = 0; i < rim_count_; ++i) {
      const MembraneNode& node = nodes_[i];
      shares[node.vertex] = steps_ > 0 ? static_cast<double>(node.gone) / steps_ : 1.0;
    }
  }

 private:
  /// Closer neighbours pull more: small faces are the stiffest, and large ones absorb the movement.
  /// But a limb's rotation shows from row to row, for rows of any length: around the limb, vertices
  /// beyond the reach pull as if they were no farther than half the hole.
  void weigh() {
    weights_.clear();
    held_.clear();
    for (const MembraneNode& node : nodes_) {
      if (node.rim) continue;
      const RimReach& reach = patch_.reach(node);
      const double away = std::min(reach.from_centre(patch_.place(node.vertex)), reach.radius);
      const double hold = away / std::max(kFade * reach.radius * reach.radius, 1e-30);
      held_.push_back(hold * hold);
      const double quarter = reach.quarter_length;
      for (const int32_t other : neighbours_.of(node.vertex)) {
        const glm::dvec2 way = difference(patch_.place(node.vertex), patch_.place(other));
        const double x = way.x * quarter;
        const double y =
            patch_.local(other) < 0 ? std::min(std::abs(way.y), reach.most_ahead) : way.y;
        weights_.emplace_back(1.0 / std::max(x * x + y * y, 1e-30),
                              1.0 / std::max(x * x + way.y * way.y, 1e-30));
      }
    }
  }

  void relax(int sweeps) {
    for (size_t i = 0; i < rim_count_; ++i) {
      nodes_[i].velocity = nodes_[i].stopped ? glm::dvec2(0.0) : nodes_[i].step;
    }
    glm::dvec2 farthest(0.0);
    for (size_t i = 0; i < rim_count_; ++i) farthest = glm::max(farthest, glm::abs(nodes_[i].step));
    for (size_t i = rim_count_; i < nodes_.size(); ++i) nodes_[i].velocity = nodes_[i].relaxed;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      size_t weight = 0;
      for (size_t i = rim_count_; i < nodes_.size(); ++i) {
        MembraneNode& node = nodes_[i];
        glm::dvec2 sum(0.0);
        glm::dvec2 weights(held_[i - rim_count_]);
        for (const int32_t v : neighbours_.of(node.vertex)) {
          const int32_t other = patch_.local(v);
          const glm::dvec2& w = weights_[weight++];
          weights += w;
          if (other >= 0) sum += nodes_[other].velocity * w;
        }
        if (weights.y > 0.0 && !node.stopped) {
          node.velocity += (sum / weights - node.velocity) * kOverRelaxation;
          // No vertex moves farther than its source, even if relaxing overshoots.
          node.velocity = glm::clamp(node.velocity, -farthest, farthest);
        }
      }
    }
    for (MembraneNode& node : nodes_) node.relaxed = node.velocity;
  }

  /// A rim's vertices wait for their neighbours and for its slowest, otherwise vertices would
  /// overrun those that are held back.
  void wait() {
    std::vector<int> slowest(reaches_.size(), steps_);
    for (size_t i = 0; i < rim_count_; ++i) {
      int& least = slowest[nodes_[i].junction];
      least = std::min(least, nodes_[i].gone);
    }
    for (size_t i = 0; i < rim_count_; ++i) {
      MembraneNode& node = nodes_[i];
      const RimReach& reach = patch_.reach(node);
      const int behind = std::min(nodes_[node.before].gone, nodes_[node.after].gone);
      const double ahead = (node.gone - slowest[node.junction]) * reach.way / steps_;
      node.stopped = node.gone > behind + kMostAhead || ahead > reach.most_ahead;
    }
  }

  void take_step(int sweeps) {
    wait();
    for (int hold = 0;; ++hold) {
      relax(sweeps);
      patch_.find_turned();
      patch_.even_out();
      if (patch_.turned().empty() || hold == kMostHolds) break;
      patch_.hold_rims();
    }
    patch_.stop_turned();
    for (size_t i = 0; i < rim_count_; ++i) nodes_[i].gone += nodes_[i].stopped ? 0 : 1;
    patch_.finish_step();
  }

  const Neighbours& neighbours_;
  MembranePatch patch_;
  std::vector<MembraneNode>& nodes_;
  const size_t rim_count_;
  std::span<const RimReach> reaches_;
  int steps_;
  /// Weights of neighbours, around the limb and along it, and of the attraction to free vertices'
  /// places.
  std::vector<glm::dvec2> weights_;
  std::vector<double> held_;
};

}  // namespace

glm::dvec2 difference(const TubePlace& from, const TubePlace& to) {
  return {short_way(to.quarter - from.quarter), to.length - from.length};
}

void move_membrane(const Neighbours& neighbours, const std::vector<Rim>& rims,
                   std::span<const RimReach> reaches, UnrolledLimbs& unrolled, Locals& locals) {
  Membrane(neighbours, rims, reaches, unrolled, locals).move(unrolled.shares);
}

}  // namespace snowbough::tree
