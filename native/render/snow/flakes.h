#pragma once

#include <glm/vec3.hpp>

#include "gpu/program.h"
#include "gpu/resources.h"
#include "render/data/view.h"
#include "shaders/lib/flake_fall.h"

namespace snowbough::render {

/// Limit on the number of flakes drawn.
inline constexpr int32_t kMaxFlakes = 200000;

/// Shader inputs of a snowfall at its time. The number of flakes in the air follows from the depth
/// that falls per second: rate = flakes per m3 * downward speed * volume of snow per flake.
/// @throws std::invalid_argument naming the value that is out of range.
shared::FlakeFall flake_fall(const Snowfall& fall);

/// Draws falling flakes over a picture. GPU thread.
class FlakePass {
 public:
  /// `view` holds the camera's TreeView. The depth buffer is tested but not written. Draws nothing
  /// at a rate of 0.
  void draw(const Snowfall& fall, const gpu::Buffer& view);

 private:
  gpu::Program program_{{"flakes.vert.glsl", "flakes.frag.glsl"}};
  gpu::Buffer block_{sizeof(shared::FlakeFall)};
};

}  // namespace snowbough::render
