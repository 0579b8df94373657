#include "tree/detail/untangle.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

#include "tree/crossings/whole.h"

namespace snowbough::tree {
namespace {

/// Rounds with projection, and without it after them; sweeps in each.
constexpr int kOnSurface = 10;
constexpr int kFree = 4;
constexpr int kSweeps = 5;
/// Cosine of the angle between the faces beside an edge beyond which they form a pleat: 107
/// degrees, more than at the corners of four-sided limbs.
constexpr double kPleat = -0.3;
/// Forks per thread at a time.
constexpr size_t kForkBlock = 8;

using Pairs = std::vector<std::pair<int32_t, int32_t>>;

void keep_once(std::vector<int32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

class Untangler {
 public:
  Untangler(const ForkFaces& forks, std::span<const double> pull, const SurfaceProjection& onto,
            std::vector<glm::dvec3>& points)
      : forks_(forks),
        pull_(pull),
        onto_(onto),
        points_(points),
        crossing_(forks.faces.size()),
        suspects_(forks.moving) {}

  std::vector<uint8_t> untangle(const base::Execution& execution) {
    constexpr int kRounds = kOnSurface + kFree;
    std::vector<uint8_t> dirty(forks_.faces.size(), 1);
    for (int round = 0; round < kRounds; ++round) {
      find_crossing(dirty, execution.part(static_cast<float>(round) / kRounds,
                                          static_cast<float>(round + 1) / kRounds));
      std::vector<int32_t> around = tangled();
      if (around.empty()) return std::vector<uint8_t>(dirty.size(), 0);
      const bool on_surface = round < kOnSurface;
      grow(on_surface ? round + 1 : 1, around);
      for (int sweep = 0; sweep < kSweeps; ++sweep) {
        for (const int32_t v : around) {
          const glm::dvec3 p = between_neighbours(v);
          points_[v] = on_surface ? onto_(v, p) : p;
        }
      }
      std::vector<uint8_t> has_moved(points_.size(), 0);
      for (const int32_t v : around) has_moved[v] = 1;
      forks_.find_dirty([&](int32_t v) { return has_moved[v] != 0; }, dirty);
      add_neighbours(around);
      suspects_ = std::move(around);
    }
    for (size_t j = 0; j < dirty.size(); ++j) dirty[j] |= crossing_[j].empty() ? 0 : 1;
    return dirty;
  }

 private:
  void find_crossing(const std::vector<uint8_t>& dirty, const base::Execution& execution) {
    base::parallel_for(dirty.size(), kForkBlock, execution, [&](size_t begin, size_t end) {
      for (size_t j = begin; j < end; ++j) {
        if (dirty[j] != 0) crossing_[j] = crossing_quads(points_, forks_.quads, forks_.faces[j]);
      }
    });
  }

  /// Vertices in pleats and of intersecting faces.
  std::vector<int32_t> tangled() const {
    std::vector<int32_t> found;
    for (const Pairs& pairs : crossing_) {
      for (const auto& [f, g] : pairs) {
        for (const int32_t face : {f, g}) {
          found.insert(found.end(), forks_.quads[face].begin(), forks_.quads[face].end());
        }
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
    const Neighbours& all = forks_.neighbours;
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
      const auto beside = forks_.neighbours.of(vertices[i]);
      vertices.insert(vertices.end(), beside.begin(), beside.end());
    }
    keep_once(vertices);
  }

  glm::dvec3 between_neighbours(int32_t vertex) const {
    const auto beside = forks_.neighbours.of(vertex);
    glm::dvec3 sum(0.0);
    for (const int32_t v : beside) {
      const glm::dvec3 offset = points_[v] - points_[vertex];
      sum += offset * std::min(1.0, pull_[vertex] / std::max(glm::length(offset), 1e-30));
    }
    return points_[vertex] + sum / static_cast<double>(beside.size());
  }

  const ForkFaces& forks_;
  std::span<const double> pull_;
  const SurfaceProjection& onto_;
  std::vector<glm::dvec3>& points_;
  /// Per fork: the last found pairs of intersecting faces.
  std::vector<Pairs> crossing_;
  /// Vertices to check for pleats: at first all moved ones, then those moved in the last round and
  /// their neighbours.
  std::vector<int32_t> suspects_;
};

}  // namespace

std::vector<uint8_t> untangle(const ForkFaces& forks, std::span<const double> pull,
                              const SurfaceProjection& onto, const base::Execution& execution,
                              std::vector<glm::dvec3>& points) {
  return Untangler(forks, pull, onto, points).untangle(execution);
}

}  // namespace snowbough::tree
