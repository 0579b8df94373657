#include "snow/walkers.h"

#include <epoxy/gl.h>

#include "gpu/egl_context.h"

namespace snowbough::snow {

int32_t walkers() {
  const auto* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  return renderer != nullptr && gpu::is_software(renderer) ? 8 : 64;
}

std::string walkers_define(int32_t walkers) {
  return "WALKERS " + std::to_string(walkers);
}

}  // namespace snowbough::snow
