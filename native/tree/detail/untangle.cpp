#include "tree/detail/untangle.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

namespace snowbough::tree {
namespace {

/// Rounds with projection, and without it after them; sweeps in each.
constexpr int kOnSurface = 5;
constexpr int kFree = 3;
constexpr int kSweeps = 3;
/// Cosine of the angle between the faces beside an edge beyond which they form a pleat: 107
/// degrees, more than at the corners of four-sided limbs.
constexpr double kPleat = -0.3;

void keep_once(std::vector<int32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

class Untangler {
 public:
  Untangler(MovedCrossings& crossings, std::span<const double> pull, const SurfaceProjection& onto,
            std::vector<glm::dvec3>& points)
      : moved_(crossings.moved),
        pull_(pull),
        onto_(onto),
        points_(points),
        crossings_(crossings),
        suspects_(crossings.moved.moving) {}

  void untangle(const base::Execution& execution) {
    constexpr int kRounds = kOnSurface + kFree;
    for (int round = 0; round < kRounds; ++round) {
      base::report_progress(execution.progress, static_cast<float>(round) / kRounds);
      std::vector<int32_t> around = tangled(crossings_.find(points_, execution.threads));
      if (around.empty()) return;
      const bool on_surface = round < kOnSurface;
      grow(on_surface ? 2 * round + 1 : 1, around);
      for (int sweep = 0; sweep < kSweeps; ++sweep) {
        for (const int32_t v : around) {
          const glm::dvec3 p = between_neighbours(v);
          points_[v] = on_surface ? onto_(v, p) : p;
        }
      }
      add_neighbours(around);
      suspects_ = std::move(around);
    }
  }

 private:
  /// Vertices in pleats and of intersecting faces.
  std::vector<int32_t> tangled(const MovedCrossings::Pairs& crossing) const {
    std::vector<int32_t> found;
    for (const auto& [f, g] : crossing) {
      for (const int32_t face : {f, g}) {
        found.insert(found.end(), moved_.quads[face].begin(), moved_.quads[face].end());
      }
    }
    for (const int32_t v : suspects_) {
      if (pull_[v] > 0.0 && in_pleat(v)) found.push_back(v);
    }
    keep_once(found);
    return found;
  }

  /// Whether two faces that share an edge at a vertex are nearly folded onto each other.
  bool in_pleat(int32_t vertex) const {
    const Neighbours& all = moved_.neighbours;
    const glm::dvec3& p = points_[vertex];
    const int32_t begin = all.begin[vertex], end = all.begin[vertex + 1];
    for (int32_t i = begin; i < end; ++i) {
      const glm::dvec3 shared = points_[all.all[i]] - p;
      const glm::dvec3 a = glm::cross(shared, points_[all.before[i]] - p);
      for (int32_t k = begin; k < end; ++k) {
        if (all.before[k] != all.all[i]) continue;
        const glm::dvec3 b = glm::cross(points_[all.all[k]] - p, shared);
        if (glm::dot(a, b) < kPleat * glm::length(a) * glm::length(b)) return true;
      }
    }
    return false;
  }

  /// Adds movable vertices up to `rings` edges away; removes fixed ones.
  void grow(int rings, std::vector<int32_t>& vertices) const {
    for (int ring = 0; ring < rings; ++ring) add_neighbours(vertices);
    std::erase_if(vertices, [&](int32_t v) { return pull_[v] <= 0.0; });
  }

  void add_neighbours(std::vector<int32_t>& vertices) const {
    const size_t count = vertices.size();
    for (size_t i = 0; i < count; ++i) {
      const auto beside = moved_.neighbours.of(vertices[i]);
      vertices.insert(vertices.end(), beside.begin(), beside.end());
    }
    keep_once(vertices);
  }

  glm::dvec3 between_neighbours(int32_t vertex) const {
    const auto beside = moved_.neighbours.of(vertex);
    glm::dvec3 sum(0.0);
    for (const int32_t v : beside) {
      const glm::dvec3 offset = points_[v] - points_[vertex];
      sum += offset * std::min(1.0, pull_[vertex] / std::max(glm::length(offset), 1e-30));
    }
    return points_[vertex] + sum / static_cast<double>(beside.size());
  }

  const MovedFaces& moved_;
  std::span<const double> pull_;
  const SurfaceProjection& onto_;
  std::vector<glm::dvec3>& points_;
  MovedCrossings& crossings_;
  /// Vertices to check for pleats: at first all moved ones, then those moved in the last round and
  /// their neighbours.
  std::vector<int32_t> suspects_;
};

}  // namespace

void untangle(MovedCrossings& crossings, std::span<const double> pull,
              const SurfaceProjection& onto, const base::Execution& execution,
              std::vector<glm::dvec3>& points) {
  Untangler(crossings, pull, onto, points).untangle(execution);
}

}  // namespace snowbough::tree
