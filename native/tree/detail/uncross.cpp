#include "tree/detail/uncross.h"

#include <algorithm>
#include <utility>

#include "tree/crossings/whole.h"

namespace snowbough::tree {
namespace {

/// Displacements at intersections are multiplied by kBack per round, and undone below kMinShare
/// of the first one, in at most kUndoRounds; the remaining shares of neighbours differ by at most
/// kShareStep.
constexpr double kBack = 0.6;
constexpr double kMinShare = 0.15;
constexpr int kUndoRounds = 8;
constexpr double kShareStep = 0.34;

/// Limits the difference between neighbours' shares to kShareStep.
void limit_differences(const MovedFaces& moved, std::vector<double>& shares) {
  for (int pass = 0; pass < 3; ++pass) {
    for (const int32_t vertex : moved.moving) {
      for (const int32_t v : moved.neighbours.of(vertex)) {
        shares[vertex] = std::min(shares[vertex], shares[v] + kShareStep);
      }
    }
  }
}

}  // namespace

const MovedCrossings::Pairs& MovedCrossings::find(const std::vector<glm::dvec3>& points,
                                                  int threads) {
  std::vector<uint8_t> changed;
  if (!before_.empty()) {
    changed.resize(moved.quads.size(), 0);
    for (const int32_t f : moved.faces) {
      const Quad& quad = moved.quads[f];
      changed[f] =
          std::any_of(quad.begin(), quad.end(), [&](int32_t v) { return points[v] != before_[v]; });
    }
    std::erase_if(pairs_, [&](const auto& pair) {
      return changed[pair.first] != 0 || changed[pair.second] != 0;
    });
  }
  for (const auto& pair : crossing_quads(points, moved.quads, moved.faces, changed, threads)) {
    const int32_t a = moved.chains[pair.first], b = moved.chains[pair.second];
    if (a == b || moved.parents[a] == b || moved.parents[b] == a) pairs_.push_back(pair);
  }
  std::sort(pairs_.begin(), pairs_.end());
  before_ = points;
  return pairs_;
}

void undo_moves(MovedCrossings& crossings, const std::vector<glm::dvec3>& before,
                const base::Execution& execution, std::vector<glm::dvec3>& points) {
  const MovedFaces& moved = crossings.moved;
  const std::vector<glm::dvec3> after(points);
  // Fraction of each vertex's displacement that is kept.
  std::vector<double> shares(points.size(), 1.0);
  for (int round = 0; round < kUndoRounds; ++round) {
    base::report_progress(execution.progress, static_cast<float>(round) / kUndoRounds);
    const MovedCrossings::Pairs& pairs = crossings.find(points, execution.threads);
    if (pairs.empty()) return;
    std::vector<double> wanted(shares);
    for (const auto& [f, g] : pairs) {
      for (const int32_t face : {f, g}) {
        for (const int32_t v : moved.quads[face]) {
          const bool gone = round + 2 >= kUndoRounds || shares[v] < kMinShare;
          wanted[v] = gone ? 0.0 : kBack * shares[v];
        }
      }
    }
    limit_differences(moved, wanted);
    for (const int32_t v : moved.moving) {
      if (wanted[v] != shares[v]) points[v] = before[v] + (after[v] - before[v]) * wanted[v];
    }
    shares = std::move(wanted);
  }
}

}  // namespace snowbough::tree
