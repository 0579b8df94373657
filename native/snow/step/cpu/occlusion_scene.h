#pragma once

#include <cstdint>
#include <glm/vec4.hpp>
#include <span>

#include "shaders/lib/snow_shared.h"
#include "snow/scene/triangle_range.h"

namespace snowbough::snow::cpu {

/// The images that cut holes into triangles, as in the scene's buffers.
struct AlphaImages {
  std::span<const shared::AlphaTriangle> triangles;
  std::span<const shared::AlphaMaskPlace> masks;
  std::span<const uint32_t> bits;
};

/// What is drawn to find out what the sky sees.
struct OcclusionScene {
  /// Three a triangle, of the triangle set-up. A triangle with a corner that is not finite is not
  /// drawn.
  std::span<const glm::vec4> corners;
  /// Drawn in their order, which decides where two surfaces coincide.
  std::span<const TriangleRange> ranges;
  /// Read for ranges with alpha only.
  AlphaImages alpha;
};

}  // namespace snowbough::snow::cpu
