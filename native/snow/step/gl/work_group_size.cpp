#include "snow/step/gl/work_group_size.h"

#include "gpu/egl_context.h"

namespace snowbough::snow {

int32_t walkers() {
  return gpu::renders_in_software() ? 8 : 64;
}

std::string walkers_define(int32_t walkers) {
  return "WALKERS " + std::to_string(walkers);
}

}  // namespace snowbough::snow
