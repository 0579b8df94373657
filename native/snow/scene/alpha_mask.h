#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <vector>

#include "shaders/lib/snow_shared.h"

namespace snowbough::snow {

/// Where an image receives snow, as one bit per texel: a leaf texture of 1024 x 1024 takes 128 KiB.
struct AlphaMask {
  int32_t width = 0;
  int32_t height = 0;
  /// Extension beyond 0 to 1: shared::kAlphaRepeat and so on.
  uint32_t extension = shared::kAlphaRepeat;
  /// Bit row * width + column, row 0 = v 0, lowest bit first: set where the surface receives snow.
  std::vector<uint32_t> bits;

  bool operator==(const AlphaMask&) const = default;
  int64_t bytes() const { return static_cast<int64_t>(bits.size() * sizeof(uint32_t)); }
};

/// The parts of an object through which snow falls: the holes of leaf cards.
struct ObjectAlpha {
  /// T x 3 texture coordinates in the images, unbounded; empty: the object is opaque.
  std::vector<glm::vec2> corner_uv;
  /// T indices into `masks`; -1: the triangle is opaque.
  std::vector<int32_t> mask;
  std::vector<std::shared_ptr<const AlphaMask>> masks;

  bool empty() const { return corner_uv.empty(); }
};

/// Marks texels that are at least half opaque. `alpha`: width x height values of 0 to 255, row 0 =
/// v 0.
/// @throws std::invalid_argument for an empty image, more than 8192 texels a side, or another
/// number of values.
AlphaMask make_alpha_mask(int32_t width, int32_t height, uint32_t extension,
                          const std::vector<uint8_t>& alpha);

/// The shader's number for REPEAT, MIRROR, EXTEND or CLIP. @throws std::invalid_argument for
/// others.
uint32_t alpha_extension(const std::string& name);

/// @throws std::invalid_argument if `alpha` does not fit a mesh of `triangles` triangles.
void check_alpha(const ObjectAlpha& alpha, size_t triangles);

}  // namespace snowbough::snow
