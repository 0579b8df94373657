#include "tree/rims/membrane.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "tree/rims/membrane_patch.h"

namespace snowbough::tree {
namespace {

/// A step is no longer than this share of the faces beside the rim; at most so many steps are made.
constexpr double kStep = 0.7;
constexpr int kMostSteps = 30;
/// Sweeps of the relaxation in the first step and in each of those after it, and its factor.
constexpr int kFirstSweeps = 25;
constexpr int kSweeps = 8;
constexpr double kOverRelaxation = 1.5;
/// What moves with a rim is held back by its place, with the square of the distance as a share of
/// the rim's reach: hardly beside the rim, where it has to make way, and at the reach as if it hung
/// on a neighbour this share of it away. Without, the whole limb would turn with the rim, as far as
/// the reach goes, and back in the one row after that.
constexpr double kFade = 0.25;
/// At first vertices near a rim go between their neighbours, in so many sweeps.
constexpr int kSpreads = 12;
/// Steps that a rim's vertex may be ahead of the next.
constexpr int kMostAhead = 1;
/// How often rims are held back within a step before what turns over stays itself.
constexpr int kMostHolds = 4;

/// Steps in which the rims get where they are to go.
int count_steps(std::span<const RimReach> rims) {
  double steps = 0.0;
  for (const RimReach& reach : rims) {
    steps = std::max(steps, reach.way / std::max(kStep * reach.spread, 1e-30));
  }
  return std::clamp(static_cast<int>(std::ceil(steps)), 0, kMostSteps);
}

/// Of a difference of quarters, the short way round.
double short_way(double quarters) {
  return std::abs(quarters) <= 2.0 ? quarters : quarters - 4.0 * std::round(quarters / 4.0);
}

/// Some rims on one chain on their way.
class Membrane {
 public:
  Membrane(const Graph& graph, const std::vector<Rim>& rims, std::span<const RimReach> reaches,
           UnrolledLimbs& unrolled, Locals& locals)
      : graph_(graph),
        patch_(graph, rims, reaches, unrolled, locals),
        nodes_(patch_.nodes),
        rim_count_(patch_.rim_count),
        reaches_(reaches),
        steps_(count_steps(reaches)) {
    for (MembraneNode& node : nodes_) node.step /= std::max(steps_, 1);
  }

  /// Moves the rims as far as they go.
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
  /// Neighbours pull the more the nearer they are: small faces are the stiffest, what moves is
  /// taken up by large ones. But what a limb turns by shows from row to row, however long the rows
  /// are: where vertices move around it, those beyond the reach hold them as if they were no
  /// further away than half the hole.
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
      for (int32_t at = graph_.begin[node.vertex]; at < graph_.begin[node.vertex + 1]; ++at) {
        const int32_t other = graph_.all[at];
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
        for (int32_t at = graph_.begin[node.vertex]; at < graph_.begin[node.vertex + 1]; ++at) {
          const int32_t other = patch_.local(graph_.all[at]);
          const glm::dvec2& w = weights_[weight++];
          weights += w;
          if (other >= 0) sum += nodes_[other].velocity * w;
        }
        if (weights.y > 0.0 && !node.stopped) {
          node.velocity += (sum / weights - node.velocity) * kOverRelaxation;
          // Nothing goes further than what pushes it, however much relaxing overshoots.
          node.velocity = glm::clamp(node.velocity, -farthest, farthest);
        }
      }
    }
    for (MembraneNode& node : nodes_) node.relaxed = node.velocity;
  }

  /// A rim's vertices wait for those beside them and for its slowest, or where some are held back
  /// others would run over them.
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

  const Graph& graph_;
  MembranePatch patch_;
  std::vector<MembraneNode>& nodes_;
  const size_t rim_count_;
  std::span<const RimReach> reaches_;
  int steps_;
  /// Of neighbours, around the limb and along it, and of the places that hold what is free back.
  std::vector<glm::dvec2> weights_;
  std::vector<double> held_;
};

}  // namespace

glm::dvec2 difference(const TubePlace& from, const TubePlace& to) {
  return {short_way(to.quarter - from.quarter), to.length - from.length};
}

void move_membrane(const Graph& graph, const std::vector<Rim>& rims,
                   std::span<const RimReach> reaches, UnrolledLimbs& unrolled, Locals& locals) {
  Membrane(graph, rims, reaches, unrolled, locals).move(unrolled.shares);
}

}  // namespace snowbough::tree
