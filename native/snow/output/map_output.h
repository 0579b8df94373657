#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace snowbough::snow {

/// What a receiver's map looks like to the outside: smoothed, continued beyond its charts, level at
/// its seams. The stored map stays as it is. Both have resolution^2 values, row 0 = v 0.
struct MapOutput {
  /// Metres.
  std::vector<float> height;
  /// Tangent space (see normals.h); empty unless asked for.
  std::vector<glm::vec3> normal;
};

}  // namespace snowbough::snow
