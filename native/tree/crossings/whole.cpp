#include "tree/crossings/whole.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "tree/crossings/faces.h"

namespace snowbough::tree {

std::vector<std::pair<int32_t, int32_t>> crossing_quads(std::span<const glm::dvec3> vertices,
                                                        std::span<const Quad> quads,
                                                        std::span<const int32_t> only) {
  std::vector<CrossingFace> faces;
  faces.reserve(only.size());
  glm::vec3 low(1e30f), high(-1e30f);
  for (const int32_t f : only) {
    faces.push_back(make_crossing_face(vertices, quads, f));
    low = glm::min(low, faces.back().low);
    high = glm::max(high, faces.back().high);
  }
  // Swept along the longest side: fewest faces begin before another ends.
  const glm::vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::sort(faces.begin(), faces.end(), [axis](const CrossingFace& a, const CrossingFace& b) {
    return a.low[axis] != b.low[axis] ? a.low[axis] < b.low[axis] : a.number < b.number;
  });
  std::vector<std::pair<int32_t, int32_t>> found;
  for (size_t i = 0; i < faces.size(); ++i) {
    const CrossingFace& f = faces[i];
    for (size_t j = i + 1; j < faces.size() && faces[j].low[axis] <= f.high[axis]; ++j) {
      const CrossingFace& g = faces[j];
      if (glm::all(glm::lessThanEqual(f.low, g.high)) &&
          glm::all(glm::lessThanEqual(g.low, f.high)) && faces_cross(f, g)) {
        found.emplace_back(std::minmax(f.number, g.number));
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace snowbough::tree
