#pragma once

#include <glm/vec3.hpp>

#include "gpu/program.h"
#include "gpu/resources.h"
#include "render/view.h"
#include "shaders/lib/flake_fall.h"

namespace snowbough::render {

/// Most flakes that are drawn at a time.
inline constexpr int32_t kMostFlakes = 200000;

/// What a fall looks like at its time. How many flakes are in the air follows from the depth that
/// they lay a second: rate = flakes a m3 * their downward speed * the snow in one. @throws
/// std::invalid_argument naming the value that is out of range.
shared::FlakeFall flake_fall(const Snowfall& fall);

/// Draws falling flakes over a picture. GPU thread.
class FlakePass {
 public:
  /// `view` holds the camera's TreeView; depth is tested and stays as it is. Nothing for a rate of
  /// 0.
  void draw(const Snowfall& fall, const gpu::Buffer& view);

 private:
  gpu::Program program_{{"flakes.vert.glsl", "flakes.frag.glsl"}};
  gpu::Buffer block_{sizeof(shared::FlakeFall)};
};

}  // namespace snowbough::render
