#include "snow/step/gl/work_group_size.h"

#include "gpu/egl_context.h"

namespace snowbough::snow {

int32_t local_size() {
  return gpu::renders_in_software() ? 8 : 64;
}

std::string local_size_define(int32_t local_size) {
  return "LOCAL_SIZE " + std::to_string(local_size);
}

}  // namespace snowbough::snow
