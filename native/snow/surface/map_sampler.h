#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/vec2.hpp>

namespace snowbough::snow {

/// A sample of a map by bilinear interpolation: the lower left of four texels, and the weights of
/// the second column and the second row.
struct MapSample {
  int32_t texel = 0;
  glm::vec2 share{0.0f};
};

/// Converts a texture coordinate to a position in a map of resolution x resolution texels.
/// `resolution` is at least 2.
inline MapSample map_sample(const glm::vec2& uv, int32_t resolution) {
  const auto along = [&](float coordinate, float& share) {
    const float last = static_cast<float>(resolution) - 1.001f;
    const float at = std::clamp(coordinate * static_cast<float>(resolution) - 0.5f, 0.0f, last);
    const auto texel = static_cast<int32_t>(at);
    share = at - static_cast<float>(texel);
    return texel;
  };
  MapSample place;
  const int32_t column = along(uv.x, place.share.x);
  place.texel = along(uv.y, place.share.y) * resolution + column;
  return place;
}

/// The bilinear interpolation of the map at this position.
inline float map_value(const float* map, int32_t resolution, const MapSample& place) {
  const float* row = map + place.texel;
  const float* next = row + resolution;
  const float low = row[0] + place.share.x * (row[1] - row[0]);
  const float high = next[0] + place.share.x * (next[1] - next[0]);
  return low + place.share.y * (high - low);
}

}  // namespace snowbough::snow
