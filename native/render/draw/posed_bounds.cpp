#include "render/draw/posed_bounds.h"

#include <glm/common.hpp>

namespace snowbough::render {

void Box::add(const glm::vec3& point) {
  low = glm::min(low, point);
  high = glm::max(high, point);
}

void Box::add(const Box& other) {
  low = glm::min(low, other.low);
  high = glm::max(high, other.high);
}

Box Box::moved(const glm::mat4& matrix) const {
  Box box;
  if (is_empty()) return box;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec4 point((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                          (corner & 4) != 0 ? high.z : low.z, 1.0f);
    box.add(glm::vec3(matrix * point));
  }
  return box;
}

Box PosedBounds::posed(std::span<const glm::mat4> matrices) const {
  Box all;
  for (size_t bone = 0; bone < rest_.size(); ++bone) all.add(rest_[bone].moved(matrices[bone]));
  return all;
}

}  // namespace snowbough::render
