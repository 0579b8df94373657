#include "snow/scene/alpha_mask.h"

#include <array>
#include <cmath>
#include <stdexcept>

namespace snowbough::snow {

namespace {

constexpr int32_t kLargestEdge = 8192;
/// Minimum alpha, of 255, of a texel that receives snow.
constexpr uint8_t kThreshold = 128;

}  // namespace

AlphaMask make_alpha_mask(int32_t width, int32_t height, uint32_t extension,
                          const std::vector<uint8_t>& alpha) {
  if (width < 1 || height < 1 || width > kLargestEdge || height > kLargestEdge) {
    throw std::invalid_argument("an alpha image has " + std::to_string(width) + " x " +
                                std::to_string(height) + " texels; it must have 1 to " +
                                std::to_string(kLargestEdge) + " per side");
  }
  const size_t texels = static_cast<size_t>(width) * static_cast<size_t>(height);
  if (alpha.size() != texels) {
    throw std::invalid_argument("an alpha image has " + std::to_string(alpha.size()) +
                                " values, its size needs " + std::to_string(texels));
  }
  AlphaMask mask{width, height, extension, std::vector<uint32_t>((texels + 31) / 32, 0)};
  for (size_t i = 0; i < texels; ++i) {
    mask.bits[i / 32] |= (alpha[i] >= kThreshold ? 1u : 0u) << (i % 32);
  }
  return mask;
}

uint32_t alpha_extension(const std::string& name) {
  static const std::array<std::pair<const char*, uint32_t>, 4> kNames{
      {{"REPEAT", shared::kAlphaRepeat},
       {"MIRROR", shared::kAlphaMirror},
       {"EXTEND", shared::kAlphaExtend},
       {"CLIP", shared::kAlphaClip}}};
  for (const auto& [known, number] : kNames) {
    if (name == known) {
      return number;
    }
  }
  throw std::invalid_argument(
      "an alpha image's extension must be REPEAT, MIRROR, EXTEND or CLIP, not " + name);
}

void check_alpha(const ObjectAlpha& alpha, size_t triangles) {
  if (alpha.corner_uv.size() != 3 * triangles || alpha.mask.size() != triangles) {
    throw std::invalid_argument(
        "its alpha must have three UVs and one image index for each of its " +
        std::to_string(triangles) + " triangles");
  }
  for (const int32_t index : alpha.mask) {
    if (index < -1 || index >= static_cast<int32_t>(alpha.masks.size())) {
      throw std::invalid_argument("its alpha refers to image " + std::to_string(index) + " of " +
                                  std::to_string(alpha.masks.size()));
    }
  }
  for (const glm::vec2& uv : alpha.corner_uv) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
      throw std::invalid_argument("its alpha has a UV that is not a finite number");
    }
  }
}

}  // namespace snowbough::snow
