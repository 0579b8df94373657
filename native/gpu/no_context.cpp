#include <stdexcept>

#include "gpu/gl_context.h"

// For systems without OpenGL 4.5, such as macOS: only the engine CPU computes snow.

namespace snowbough::gpu {

std::string why_no_hardware() {
  return "this system has no OpenGL 4.5";
}

GlContext::GlContext(const std::string& /*device*/) {
  throw std::runtime_error("this system has no OpenGL 4.5: choose the engine CPU");
}

GlContext::~GlContext() = default;

}  // namespace snowbough::gpu
