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
/// relative to the rim's reach: hardly beside the rim, where they must move, and at the reach
/// as strongly as by a neighbour at this fraction of it. Without this, the whole limb would rotate
/// with the rim up to the reach, and back within a single row.
constexpr double kFade = 0.25;
/// Initial sweeps that move vertices near a rim between their neighbours.
constexpr int kSpreads = 12;
/// Maximum lead in steps of a rim's vertex over the next.
constexpr int kMostAhead = 1;
/// Maximum number of times that rims are stopped within a step before turned faces are stopped
/// themselves.
constexpr int kMostStops = 4;

/// Number of steps until the rims reach their targets.
int count_steps(std::span<const RimReach> rims) {
  double steps = 0.0;
  for (const RimReach& reach : rims) {
    steps = std::max(steps, reach.farthest / std::max(kStep * reach.spread, 1e-30));
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
      set_weights();
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
  void set_weights() {
    weights_.clear();
    attraction_.clear();
    for (const MembraneNode& node : nodes_) {
      if (node.rim) continue;
      const RimReach& reach = patch_.reach(node);
      const double away = std::min(reach.from_centre(patch_.place(node.vertex)), reach.radius);
      const double pull = away / std::max(kFade * reach.radius * reach.radius, 1e-30);
      attraction_.push_back(pull * pull);
      const double quarter = reach.quarter_length;
      for (const int32_t other : neighbours_.of(node.vertex)) {
        const glm::dvec2 offset = difference(patch_.place(node.vertex), patch_.place(other));
        const double x = offset.x * quarter;
        const double y =
            patch_.local(other) < 0 ? std::min(std::abs(offset.y), reach.most_ahead) : offset.y;
        weights_.emplace_back(1.0 / std::max(x * x + y * y, 1e-30),
                              1.0 / std::max(x * x + offset.y * offset.y, 1e-30));
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
        glm::dvec2 weights(attraction_[i - rim_count_]);
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

  /// Stops vertices of a rim that are ahead of their neighbours or of the rim's slowest vertex, so
  /// that they do not pass stopped ones.
  void limit_lead() {
    std::vector<int> slowest(reaches_.size(), steps_);
    for (size_t i = 0; i < rim_count_; ++i) {
      int& least = slowest[nodes_[i].junction];
      least = std::min(least, nodes_[i].gone);
    }
    for (size_t i = 0; i < rim_count_; ++i) {
      MembraneNode& node = nodes_[i];
      const RimReach& reach = patch_.reach(node);
      const int behind = std::min(nodes_[node.before].gone, nodes_[node.after].gone);
      const double ahead = (node.gone - slowest[node.junction]) * reach.farthest / steps_;
      node.stopped = node.gone > behind + kMostAhead || ahead > reach.most_ahead;
    }
  }

  void take_step(int sweeps) {
    limit_lead();
    for (int stops = 0;; ++stops) {
      relax(sweeps);
      patch_.find_turned();
      patch_.relax_turned();
      if (patch_.turned().empty() || stops == kMostStops) break;
      patch_.stop_rims();
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
  std::vector<double> attraction_;
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
