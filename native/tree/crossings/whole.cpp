#include "tree/crossings/whole.h"

#include <algorithm>
#include <glm/vector_relational.hpp>

#include "tree/crossings/faces.h"

namespace snowbough::tree {

std::vector<std::pair<int32_t, int32_t>> crossing_quads(const std::vector<glm::vec3>& vertices,
                                                        const std::vector<Quad>& quads) {
  Surface surface;
  surface.vertices.assign(vertices.begin(), vertices.end());
  surface.quads = quads;
  std::vector<CrossingFace> faces;
  faces.reserve(quads.size());
  for (size_t f = 0; f < quads.size(); ++f) {
    faces.push_back(make_crossing_face(surface, static_cast<int32_t>(f)));
  }
  std::sort(faces.begin(), faces.end(), [](const CrossingFace& a, const CrossingFace& b) {
    return a.low.x != b.low.x ? a.low.x < b.low.x : a.number < b.number;
  });
  std::vector<std::pair<int32_t, int32_t>> found;
  for (size_t i = 0; i < faces.size(); ++i) {
    const CrossingFace& f = faces[i];
    for (size_t j = i + 1; j < faces.size() && faces[j].low.x <= f.high.x; ++j) {
      const CrossingFace& g = faces[j];
      if (glm::all(glm::lessThanEqual(f.low, g.high)) &&
          glm::all(glm::lessThanEqual(g.low, f.high)) && faces_cross(f, g)) {
        found.push_back(std::minmax(f.number, g.number));
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace snowbough::tree
