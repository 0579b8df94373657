#pragma once

// Helpers for the tests of occlusion on the processor.
#include <cstring>
#include <glm/vec4.hpp>
#include <vector>

#include "snow/step/cpu/occlusion/occlusion.h"
#include "snow/step/cpu/passes.h"

namespace snowbough::snow {

using Seen = std::vector<shared::SeenPixel>;
using Corners = std::vector<glm::vec4>;

/// A corner at a local pixel and a depth.
inline glm::vec4 at(float x, float y, float depth = 0.0f) {
  return {x, y, depth, 0.0f};
}

inline Seen seen_of(const Corners& corners, const PixelRect& pixels,
                    std::vector<TriangleRange> ranges = {}, const cpu::AlphaImages& alpha = {},
                    const cpu::OcclusionPass::Options& options = {}) {
  if (ranges.empty()) ranges = {{0, static_cast<int32_t>(corners.size() / 3)}};
  const glm::ivec2 size = pixels.size();
  // The initial content must not matter.
  Seen seen(static_cast<size_t>(size.x) * static_cast<size_t>(size.y), {7u, 7.0f});
  cpu::OcclusionPass(options).run({corners, ranges, alpha}, pixels, seen);
  return seen;
}

inline PixelRect square_of(int32_t size) {
  return {{0, 0}, {size, size}};
}

inline bool same_bits(const Seen& a, const Seen& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

struct TrianglesSetUp {
  Corners corners;
  std::vector<glm::vec4> surface;
};

inline TrianglesSetUp set_up(const std::vector<glm::vec3>& positions,
                             const std::vector<shared::SceneTriangle>& triangles,
                             const shared::ProjectionFrame& frame) {
  TrianglesSetUp made{Corners(3 * triangles.size()), std::vector<glm::vec4>(triangles.size())};
  cpu::set_up_triangles(positions, triangles, frame, made.corners, made.surface);
  return made;
}

}  // namespace snowbough::snow
