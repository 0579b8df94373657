#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace snowbough::snow {

/// A receiver's map for display: smoothed, extended beyond its charts, level across its seams. The
/// stored map stays unchanged. Both arrays have resolution^2 values, row 0 = v 0.
struct MapOutput {
  /// Metres.
  std::vector<float> height;
  /// Tangent space (see normals.h); empty unless asked for.
  std::vector<glm::vec3> normal;
};

}  // namespace snowbough::snow
