#include "snow/texels/merge_vertices.h"

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <unordered_map>

namespace snowbough::snow {
namespace {

/// Vertices closer than this fraction of the mesh's size coincide.
constexpr float kOnePlace = 1e-6f;

/// Finds the first vertex at each position, with a grid of cells that contain few vertices.
class Welder {
 public:
  Welder(const std::vector<glm::vec3>& positions, int32_t count) : positions_(positions) {
    glm::vec3 low(1e30f);
    glm::vec3 high(-1e30f);
    for (int32_t v = 0; v < count; ++v) {
      low = glm::min(low, positions[static_cast<size_t>(v)]);
      high = glm::max(high, positions[static_cast<size_t>(v)]);
    }
    low_ = low;
    near_ = count > 0 ? kOnePlace * glm::length(high - low) : 0.0f;
    first_.reserve(static_cast<size_t>(count));
    for (int32_t v = 0; v < count; ++v) first_.push_back(add(v));
  }
  int32_t first(int32_t vertex) const { return first_[static_cast<size_t>(vertex)]; }

 private:
  uint64_t cell(const glm::vec3& point) const {
    // Counted from the mesh's corner, so that the numbers stay small also far from the origin.
    const glm::dvec3 inside = glm::dvec3(point) - glm::dvec3(low_);
    const glm::dvec3 at = glm::floor(inside / (16.0 * std::max<double>(near_, 1e-30)));
    const auto part = [](double x) { return static_cast<uint64_t>(static_cast<int64_t>(x)); };
    return (part(at.x) * 73856093u) ^ (part(at.y) * 19349663u) ^ (part(at.z) * 83492791u);
  }

  int32_t add(int32_t vertex) {
    const glm::vec3 point = positions_[static_cast<size_t>(vertex)];
    int32_t found = vertex;
    // Cells that may contain a coincident vertex: usually one.
    for (int k = 0; k < 8; ++k) {
      const glm::vec3 away((k & 1) != 0 ? near_ : -near_, (k & 2) != 0 ? near_ : -near_,
                           (k & 4) != 0 ? near_ : -near_);
      const auto here = cells_.find(cell(point + away));
      if (here == cells_.end()) continue;
      for (const int32_t other : here->second) {
        const glm::vec3 apart = glm::abs(positions_[static_cast<size_t>(other)] - point);
        if (std::max(apart.x, std::max(apart.y, apart.z)) <= near_) found = std::min(found, other);
      }
    }
    if (found == vertex) cells_[cell(point)].push_back(vertex);
    return found;
  }

  const std::vector<glm::vec3>& positions_;
  glm::vec3 low_{0.0f};
  float near_ = 0.0f;
  /// Never iterated over.
  std::unordered_map<uint64_t, std::vector<int32_t>> cells_;
  std::vector<int32_t> first_;
};

}  // namespace

MapTopology merge_vertices(const MapTopology& topology, const std::vector<glm::vec3>& positions) {
  const Welder welder(positions, topology.vertex_count);
  MapTopology result = topology;
  for (int32_t& v : result.triangles) v = welder.first(v);
  return result;
}

}  // namespace snowbough::snow
