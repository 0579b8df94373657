#include "tree/detail/uncross.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "tree/crossings/whole.h"

namespace snowbough::tree {
namespace {

/// Displacements at intersections are multiplied by kBack per round, and undone below kLeastShare
/// of the first one, in at most kUncrossRounds; the remaining shares of neighbours differ by at
/// most kShareStep.
constexpr double kBack = 0.6;
constexpr double kLeastShare = 0.15;
constexpr int kUncrossRounds = 8;
constexpr double kShareStep = 0.34;
/// Fraction of the distance to the neighbours' mean that remaining intersections move per round,
/// and the maximum number of rounds.
constexpr double kSmoothing = 0.5;
constexpr int kSmoothRounds = 12;
/// Progress at which undoing is finished.
constexpr float kUndone = 0.9f;
/// Forks per thread at a time.
constexpr size_t kDirtyForkBlock = 8;

using Pairs = std::vector<std::pair<int32_t, int32_t>>;

class Uncrosser {
 public:
  Uncrosser(const ForkFaces& forks, const std::vector<glm::dvec3>& before,
            std::vector<glm::dvec3>& points)
      : forks_(forks),
        before_(before),
        points_(points),
        crossing_(forks.faces.size()),
        crossed_before_(forks.faces.size()) {}

  void undo_moves(const base::Execution& execution, std::vector<uint8_t> dirty = {}) {
    const std::vector<glm::dvec3> moved(points_);
    // Fraction of each vertex's displacement that is kept.
    std::vector<double> shares(points_.size(), 1.0);
    if (dirty.empty()) dirty.assign(forks_.faces.size(), 1);
    for (int round = 0; round < kUncrossRounds; ++round) {
      find(dirty, execution.part(static_cast<float>(round) / kUncrossRounds,
                                 static_cast<float>(round + 1) / kUncrossRounds));
      std::vector<double> wanted(shares);
      bool crosses = false;
      for (size_t j = 0; j < crossing_.size(); ++j) {
        if (dirty[j] == 0) continue;
        for (const auto& pair : crossing_[j]) {
          const Pairs& before = crossed_before_[j];
          if (std::binary_search(before.begin(), before.end(), pair)) continue;
          crosses = true;
          for (const int32_t face : {pair.first, pair.second}) {
            for (const int32_t v : forks_.quads[face]) {
              const bool gone = round + 2 >= kUncrossRounds || shares[v] < kLeastShare;
              wanted[v] = gone ? 0.0 : kBack * shares[v];
            }
          }
        }
      }
      if (!crosses) return;
      limit_differences(wanted);
      for (const int32_t v : forks_.moving) {
        if (wanted[v] != shares[v]) points_[v] = before_[v] + (moved[v] - before_[v]) * wanted[v];
      }
      forks_.find_dirty([&](int32_t v) { return shares[v] != wanted[v]; }, dirty);
      shares = std::move(wanted);
    }
    find(dirty, execution);
  }

  void smooth() {
    std::vector<uint8_t> moves(points_.size(), 0);
    for (const int32_t v : forks_.moving) moves[v] = 1;
    for (size_t j = 0; j < crossing_.size(); ++j) {
      if (!crossing_[j].empty()) smooth(forks_.faces[j], moves);
    }
  }

 private:
  /// Finds the intersections in the dirty forks and, if there are any, those before the move.
  void find(const std::vector<uint8_t>& dirty, const base::Execution& execution) {
    base::parallel_for(dirty.size(), kDirtyForkBlock, execution, [&](size_t begin, size_t end) {
      for (size_t j = begin; j < end; ++j) {
        if (dirty[j] == 0) continue;
        crossing_[j] = crossing_quads(points_, forks_.quads, forks_.faces[j]);
        if (!crossing_[j].empty() && crossed_before_[j].empty()) {
          crossed_before_[j] = crossing_quads(before_, forks_.quads, forks_.faces[j]);
        }
      }
    });
  }

  /// Limits the difference between neighbours' fractions to kShareStep.
  void limit_differences(std::vector<double>& shares) const {
    for (int pass = 0; pass < 3; ++pass) {
      for (const int32_t vertex : forks_.moving) {
        for (const int32_t v : forks_.neighbours.of(vertex)) {
          shares[vertex] = std::min(shares[vertex], shares[v] + kShareStep);
        }
      }
    }
  }

  /// The movable corners of intersecting faces and their neighbours.
  std::vector<int32_t> around(const Pairs& crossing, const std::vector<uint8_t>& moves) const {
    std::vector<int32_t> vertices;
    for (const auto& [f, g] : crossing) {
      for (const int32_t face : {f, g}) {
        for (const int32_t v : forks_.quads[face]) {
          vertices.push_back(v);
          const auto beside = forks_.neighbours.of(v);
          vertices.insert(vertices.end(), beside.begin(), beside.end());
        }
      }
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::erase_if(vertices, [&](int32_t v) { return moves[v] == 0; });
    return vertices;
  }

  void smooth(const std::vector<int32_t>& faces, const std::vector<uint8_t>& moves) {
    // An earlier fork may have repaired it.
    Pairs crossing = crossing_quads(points_, forks_.quads, faces);
    const size_t at_first = crossing.size();
    std::vector<std::pair<int32_t, glm::dvec3>> kept;
    for (int round = 0; round < kSmoothRounds && !crossing.empty(); ++round) {
      const size_t first = kept.size();
      for (const int32_t v : around(crossing, moves)) kept.emplace_back(v, points_[v]);
      std::vector<glm::dvec3> places;
      for (size_t i = first; i < kept.size(); ++i) {
        const auto beside = forks_.neighbours.of(kept[i].first);
        glm::dvec3 sum(0.0);
        for (const int32_t v : beside) sum += points_[v];
        const glm::dvec3 middle = sum / static_cast<double>(beside.size());
        places.push_back(kept[i].second + (middle - kept[i].second) * kSmoothing);
      }
      for (size_t i = first; i < kept.size(); ++i) points_[kept[i].first] = places[i - first];
      crossing = crossing_quads(points_, forks_.quads, faces);
    }
    if (crossing.size() < at_first) return;
    for (size_t i = kept.size(); i-- > 0;) points_[kept[i].first] = kept[i].second;
  }

  const ForkFaces& forks_;
  const std::vector<glm::dvec3>& before_;
  std::vector<glm::dvec3>& points_;
  /// Per fork: the last found pairs of intersecting faces, and those before the move.
  std::vector<Pairs> crossing_, crossed_before_;
};

}  // namespace

void undo_moves(const ForkFaces& forks, const std::vector<glm::dvec3>& before,
                const base::Execution& execution, std::vector<glm::dvec3>& points) {
  Uncrosser(forks, before, points).undo_moves(execution);
}

void uncross(const ForkFaces& forks, const std::vector<glm::dvec3>& before,
             const base::Execution& execution, std::vector<glm::dvec3>& points,
             std::vector<uint8_t> dirty) {
  Uncrosser uncrosser(forks, before, points);
  uncrosser.undo_moves(execution.part(0.0f, kUndone), std::move(dirty));
  uncrosser.smooth();
}

}  // namespace snowbough::tree
