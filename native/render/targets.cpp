#include "render/targets.h"

namespace snowbough::render {
namespace {

gpu::Framebuffer framebuffer_of(const gpu::Texture& color, const gpu::Texture& depth) {
  std::vector<const gpu::Texture*> colors;
  if (color.id() != 0) colors.push_back(&color);
  return gpu::Framebuffer(colors, &depth);
}

}  // namespace

Target::Target(int32_t target_width, int32_t target_height, GLenum color_format)
    : width(target_width),
      height(target_height),
      color(color_format != GL_NONE ? gpu::Texture(color_format, width, height, 0, GL_LINEAR)
                                    : gpu::Texture()),
      depth(GL_DEPTH_COMPONENT32F, width, height),
      framebuffer(framebuffer_of(color, depth)) {}

void Target::begin(float red, float green, float blue) const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  glViewport(0, 0, width, height);
  const float clear[] = {red, green, blue, 0.0f};
  if (color.id() != 0) glClearNamedFramebufferfv(framebuffer.id(), GL_COLOR, 0, clear);
  const float far = 1.0f;
  glClearNamedFramebufferfv(framebuffer.id(), GL_DEPTH, 0, &far);
}

Target& ReusedTarget::of_size(int32_t width, int32_t height) {
  if (!target_ || target_->width != width || target_->height != height) {
    target_.reset();
    target_.emplace(width, height, color_format_);
  }
  return *target_;
}

void halve(const Target& large, const Target& small) {
  glBlitNamedFramebuffer(large.framebuffer.id(), small.framebuffer.id(), 0, 0, large.width,
                         large.height, 0, 0, small.width, small.height, GL_COLOR_BUFFER_BIT,
                         GL_LINEAR);
}

std::vector<uint8_t> read_color(const Target& target) {
  std::vector<uint8_t> pixels(static_cast<size_t>(target.width) * target.height * 4);
  target.color.read(0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<int64_t>(pixels.size()),
                    pixels.data());
  return pixels;
}

}  // namespace snowbough::render
