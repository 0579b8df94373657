#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gpu/resources.h"

namespace snowbough::render {

/// What is drawn into: a colour and a depth texture. Its content is undefined until cleared.
struct Target {
  /// `color_format` sized, as GL_RGBA8; GL_NONE: depth alone.
  Target(int32_t width, int32_t height, GLenum color_format);

  /// Draws go here from now on, with the viewport at its size; both are cleared.
  void begin(float red, float green, float blue) const;

  int32_t width = 0;
  int32_t height = 0;
  gpu::Texture color;
  gpu::Texture depth;
  gpu::Framebuffer framebuffer;
};

/// A target that is kept as long as its size stays.
class KeptTarget {
 public:
  explicit KeptTarget(GLenum color_format) : color_format_(color_format) {}
  Target& of_size(int32_t width, int32_t height);

 private:
  GLenum color_format_;
  std::optional<Target> target_;
};

/// Means of 2 x 2 pixels of `large`, into a target of half its size.
void halve(const Target& large, const Target& small);

/// A target's pixels: height x width x 4, row 0 at the bottom.
std::vector<uint8_t> read_color(const Target& target);

}  // namespace snowbough::render
