#include "snow/scene/fragment_opacity.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "base/parallel_for.h"
#include "shaders/lib/occlusion_pixel.h"

namespace snowbough::snow {
namespace {

/// Sample points per side of a fragment.
constexpr int32_t kPoints = 4;

bool is_there(const AlphaMask& mask, glm::vec2 uv) {
  const shared::AlphaMaskHeader header{0, static_cast<uint32_t>(mask.width),
                                       static_cast<uint32_t>(mask.height), mask.extension};
  const uint32_t bit = shared::mask_bit(uv, header);
  return bit != shared::kNowhere && !shared::is_hole(mask.bits[bit >> 5], bit);
}

/// A triangle with an image, and the change of the weights of its second and third corner per texel
/// of the map.
struct MaskedTriangle {
  MaskedTriangle(const MapTopology& topology, const ObjectAlpha& alpha, size_t triangle)
      : mask(*alpha.masks[static_cast<size_t>(alpha.mask[triangle])]),
        image(&alpha.corner_uv[3 * triangle]) {
    const glm::vec2* uv = &topology.corner_uv[3 * triangle];
    const glm::vec2 b = (uv[1] - uv[0]) * static_cast<float>(topology.resolution);
    const glm::vec2 c = (uv[2] - uv[0]) * static_cast<float>(topology.resolution);
    const float twice = b.x * c.y - b.y * c.x;
    along_u = glm::vec2(c.y, -b.y) / twice;
    along_v = glm::vec2(-c.x, b.x) / twice;
    texels = 0.5f * std::abs(twice);
  }

  /// Weights outside the triangle are clamped to its rim.
  bool is_there_at(glm::vec2 weights) const {
    weights = glm::max(weights, 0.0f);
    weights /= std::max(weights.x + weights.y, 1.0f);
    return is_there(
        mask, image[0] + weights.x * (image[1] - image[0]) + weights.y * (image[2] - image[0]));
  }

  const AlphaMask& mask;
  const glm::vec2* image;
  glm::vec2 along_u;
  glm::vec2 along_v;
  float texels;
};

/// Opacity of a fragment with `share` of the triangle around `centre`, taken as a square.
float opacity_of(const MaskedTriangle& triangle, float share, glm::vec2 centre) {
  const float size = std::sqrt(std::min(1.0f, share * triangle.texels));
  int32_t there = 0;
  for (int32_t i = 0; i < kPoints * kPoints; ++i) {
    const float u = (static_cast<float>(i % kPoints) + 0.5f) / kPoints - 0.5f;
    const float v = (static_cast<float>(i / kPoints) + 0.5f) / kPoints - 0.5f;
    there +=
        triangle.is_there_at(centre + size * (u * triangle.along_u + v * triangle.along_v)) ? 1 : 0;
  }
  return static_cast<float>(there) / (kPoints * kPoints);
}

}  // namespace

std::vector<float> fragment_opacity(const TexelTable& table, const MapTopology& topology,
                                    const ObjectAlpha& alpha) {
  if (alpha.empty()) return {};
  std::vector<float> opacity(table.fragment_triangle.size(), 1.0f);
  base::parallel_for(base::default_threads(), [&](size_t part, size_t parts) {
    const size_t end = opacity.size() * (part + 1) / parts;
    for (size_t f = opacity.size() * part / parts; f < end; ++f) {
      const auto triangle = static_cast<size_t>(table.fragment_triangle[f]);
      if (alpha.mask[triangle] < 0) continue;
      opacity[f] = opacity_of(MaskedTriangle(topology, alpha, triangle), table.fragment_share[f],
                              table.fragment_barycentric[f]);
    }
  });
  return opacity;
}

}  // namespace snowbough::snow
