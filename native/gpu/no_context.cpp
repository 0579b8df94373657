#include <stdexcept>

#include "gpu/gl_context.h"

// Where there is no OpenGL 4.5, as on macOS: snow falls on the processor.

namespace snowbough::gpu {

std::string why_no_hardware() {
  return "this system has no OpenGL 4.5";
}

GlContext::GlContext(const std::string& /*device*/) {
  throw std::runtime_error("this system has no OpenGL 4.5: choose the engine CPU");
}

GlContext::~GlContext() = default;

}  // namespace snowbough::gpu
