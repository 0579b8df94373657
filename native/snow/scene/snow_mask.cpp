#include "snow/scene/snow_mask.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace snowbough::snow {
namespace {

void check_weights(const std::vector<float>& weights) {
  const auto is_wrong = [](float weight) { return !(weight >= 0.0f && weight <= 1.0f); };
  const auto wrong = std::find_if(weights.begin(), weights.end(), is_wrong);
  if (wrong == weights.end()) return;
  throw std::invalid_argument("mask: values must be from 0 to 1, one is " + std::to_string(*wrong));
}

void check_mask(const SnowMask& mask, size_t triangles) {
  const bool has_image = !mask.image.empty();
  const size_t corners = has_image ? mask.corner_uv.size() : mask.corner_weights.size();
  if (corners != 3 * triangles) {
    throw std::invalid_argument("mask: there are " + std::to_string(corners) +
                                " corners, the object has " + std::to_string(3 * triangles));
  }
  const size_t pixels = static_cast<size_t>(mask.width) * static_cast<size_t>(mask.height);
  if (has_image && mask.image.size() != pixels) {
    throw std::invalid_argument("mask: the image has not width x height values");
  }
  const auto is_finite = [](glm::vec2 uv) { return std::isfinite(uv.x) && std::isfinite(uv.y); };
  if (!std::all_of(mask.corner_uv.begin(), mask.corner_uv.end(), is_finite)) {
    throw std::invalid_argument("mask: texture coordinates must be finite");
  }
  check_weights(mask.corner_weights);
  check_weights(mask.image);
}

/// The two pixels around a coordinate along one side of the image, and the weight of the second.
struct Pair {
  size_t first, second;
  float weight;
};

Pair pixels_around(float coordinate, int32_t count) {
  const double turn = static_cast<double>(coordinate) - std::floor(static_cast<double>(coordinate));
  const double at = turn * count - 0.5;
  const double below = std::floor(at);
  const auto first = static_cast<int32_t>(below);
  return {static_cast<size_t>((first + count) % count), static_cast<size_t>((first + 1) % count),
          static_cast<float>(at - below)};
}

float sample(const SnowMask& mask, glm::vec2 uv) {
  const Pair x = pixels_around(uv.x, mask.width);
  const Pair y = pixels_around(uv.y, mask.height);
  const auto row = [&](size_t number) {
    const float* const first = &mask.image[number * static_cast<size_t>(mask.width)];
    return std::lerp(first[x.first], first[x.second], x.weight);
  };
  return std::clamp(std::lerp(row(y.first), row(y.second), y.weight), 0.0f, 1.0f);
}

}  // namespace

std::vector<float> texel_weights(const SnowMask& mask, const TexelTable& table, size_t triangles) {
  check_mask(mask, triangles);
  std::vector<float> weights(table.texel.size());
  for (size_t i = 0; i < weights.size(); ++i) {
    const size_t corner = 3 * static_cast<size_t>(table.triangle[i]);
    const glm::vec2 second = table.barycentric[i];
    const auto mix = [&](const auto& values) {
      const auto first = values[corner];
      return first + second.x * (values[corner + 1] - first) +
             second.y * (values[corner + 2] - first);
    };
    weights[i] = mask.image.empty() ? std::clamp(mix(mask.corner_weights), 0.0f, 1.0f)
                                    : sample(mask, mix(mask.corner_uv));
  }
  return weights;
}

}  // namespace snowbough::snow
