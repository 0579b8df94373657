#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <vector>

#include "base/triangle_tree.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// Another receiver that stands near, with its snow.
struct Neighbour {
  SurfaceSource source;
  /// Thickness along the normals, resolution x resolution, in metres.
  std::vector<float> height;
};

/// The first face straight below a place, at most `most` metres below. Within a body, as where a
/// slab ends in a kerb, the body's top above the place, at a distance below 0; none if it is more
/// than `highest` above.
base::TriangleTree::Hit ground_at(const base::TriangleTree& tree,
                                  const std::vector<glm::vec3>& position,
                                  const std::vector<std::array<int32_t, 3>>& triangle,
                                  const glm::dvec3& place, double most, double highest);

/// True if a place lies within a piece: upwards and to both sides, its faces are seen from behind.
bool is_within(const base::TriangleTree& tree, const std::vector<glm::vec3>& position,
               const std::vector<std::array<int32_t, 3>>& triangle, const glm::dvec3& place);

/// The faces of the other receivers, for what lies beyond the rims of one.
class Beyond {
 public:
  explicit Beyond(const std::vector<Neighbour>& neighbours);

  struct Below {
    /// Metres below the place, or below 0 (ground_at); infinite: nothing.
    double drop = std::numeric_limits<double>::infinity();
    /// Thickness of the snow there along the vertical, in metres.
    float thickness = 0.0f;
  };
  /// As ground_at.
  Below below(const glm::dvec3& place, double most, double highest) const;
  /// As is_within.
  bool surround(const glm::dvec3& place) const;

 private:
  const std::vector<Neighbour>& neighbours_;
  /// Where the points and the triangles of each neighbour begin.
  std::vector<int32_t> first_point_, first_triangle_;
  std::vector<glm::vec3> position_;
  std::vector<std::array<int32_t, 3>> triangle_;
  std::unique_ptr<base::TriangleTree> tree_;
};

}  // namespace snowbough::snow
