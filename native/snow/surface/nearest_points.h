#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "snow/surface/point_tree.h"

namespace snowbough::snow {

/// A mean over up to four points of a surface.
struct PointMean {
  glm::ivec4 point{0};
  glm::vec4 weight{0.0f};

  /// The mean of values at the points; negative values count as 0.
  float of(const std::vector<float>& values) const {
    float sum = 0.0f;
    for (int k = 0; k < 4; ++k) sum += weight[k] * std::max(values[point[k]], 0.0f);
    return sum;
  }
};

/// Finds the points nearest to a place among some points of a surface.
class NearestPoints {
 public:
  /// @param position all points.
  /// @param chosen the points to choose from.
  /// @param sheltered 1 for points below another surface.
  NearestPoints(const std::vector<glm::vec3>& position, std::vector<int32_t> chosen,
                const std::vector<uint8_t>& sheltered, float depth);

  /// The mean over the points nearest to `place`, weighted by distance, up to about `farthest`
  /// metres away; point `own` alone if there are none. Sheltered points count only if `shelter`.
  PointMean at(const glm::vec3& place, int32_t own, float farthest, bool shelter) const;

  const std::vector<int32_t>& chosen() const { return chosen_; }

 private:
  std::vector<int32_t> chosen_;
  float depth_;
  /// The chosen points under the open sky, and a tree of them; a tree of all chosen points.
  std::vector<int32_t> open_;
  PointTree open_tree_, tree_;
};

}  // namespace snowbough::snow
