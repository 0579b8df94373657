#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <vector>

#include "shaders/lib/snow_shared.h"

namespace snowbough::snow {

/// Where an image lets snow through, as one bit a texel: a leaf texture of 1024 x 1024 takes 128
/// KiB.
struct AlphaMask {
  int32_t width = 0;
  int32_t height = 0;
  /// What lies beyond 0 to 1: shared::kAlphaRepeat and so on.
  uint32_t extension = shared::kAlphaRepeat;
  /// Bit row * width + column, row 0 = v 0, lowest bit first: set where snow meets the surface.
  std::vector<uint32_t> bits;

  bool operator==(const AlphaMask&) const = default;
  int64_t bytes() const { return static_cast<int64_t>(bits.size() * sizeof(uint32_t)); }
};

/// Where an object is not there for snow, although its triangles are: the holes of leaf cards.
struct ObjectAlpha {
  /// T x 3 texture coordinates in the images, any real numbers; empty: the object is opaque.
  std::vector<glm::vec2> corner_uv;
  /// T indices into `masks`; -1 = the triangle is opaque.
  std::vector<int32_t> mask;
  std::vector<std::shared_ptr<const AlphaMask>> masks;

  bool empty() const { return corner_uv.empty(); }
};

/// Keeps what is at least half opaque: `alpha` are width x height values of 0 to 255, row 0 = v 0.
/// @throws std::invalid_argument for an image without texels or of more than 8192 a side, or where
/// the values are not width x height many.
AlphaMask make_alpha_mask(int32_t width, int32_t height, uint32_t extension,
                          const std::vector<uint8_t>& alpha);

/// REPEAT, MIRROR, EXTEND or CLIP as the shader's number, or std::invalid_argument.
uint32_t alpha_extension(const std::string& name);

/// @throws std::invalid_argument when `alpha` does not belong to a mesh of `triangles` triangles.
void check_alpha(const ObjectAlpha& alpha, size_t triangles);

}  // namespace snowbough::snow
