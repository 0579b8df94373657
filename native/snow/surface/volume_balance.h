#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace snowbough::snow {

/// Keeps the volume of the drawn snow equal to that of the map, place by place: what fronts and the
/// edges of thin snow add or take is made up for within two cells of the places where they do so.
/// Far from them snow is drawn as high as the map says.
class VolumeBalance {
 public:
  VolumeBalance() = default;
  /// @param size edge length of a cell in metres, over 0.
  VolumeBalance(const std::vector<glm::vec3>& position, float size);

  /// Factors on the heights of the points.
  /// @param volumes per point: what the map holds and what is drawn, both not under 0, in m3.
  std::vector<float> factors(const std::vector<glm::vec2>& volumes) const;

 private:
  /// Corners of the cell around a point, and their shares in the point, which sum to 1.
  struct Near {
    std::array<int32_t, 8> corner{};
    std::array<float, 8> share{};
  };
  std::vector<Near> near_;
  size_t corners_ = 0;
};

}  // namespace snowbough::snow
