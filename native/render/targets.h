#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gpu/resources.h"

namespace snowbough::render {

/// A render target: a colour and a depth texture. The content is undefined until it is cleared.
struct Target {
  /// `color_format` is a sized format, such as GL_RGBA8, or GL_NONE for depth only.
  Target(int32_t width, int32_t height, GLenum color_format);

  /// Binds the target, sets the viewport to its size, and clears colour and depth.
  void begin(float red, float green, float blue) const;

  int32_t width = 0;
  int32_t height = 0;
  gpu::Texture color;
  gpu::Texture depth;
  gpu::Framebuffer framebuffer;
};

/// A target that is reused until its size changes.
class ReusedTarget {
 public:
  explicit ReusedTarget(GLenum color_format) : color_format_(color_format) {}
  Target& of_size(int32_t width, int32_t height);

 private:
  GLenum color_format_;
  std::optional<Target> target_;
};

/// Averages 2 x 2 pixels of `large` into `small`, a target of half its size.
void halve(const Target& large, const Target& small);

/// A target's pixels: height x width x 4, row 0 at the bottom.
std::vector<uint8_t> read_color(const Target& target);

}  // namespace snowbough::render
