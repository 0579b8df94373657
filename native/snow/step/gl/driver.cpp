#include "snow/step/gl/driver.h"

#include <epoxy/gl.h>

#include "snow/scene/memory_estimate.h"

namespace snowbough::snow {

int64_t available_memory(const gpu::GpuInfo& info) {
  const bool software = gpu::is_software(info.renderer);
  if (!software && epoxy_has_gl_extension("GL_NVX_gpu_memory_info")) {
    GLint kibibytes = 0;
    glGetIntegerv(GL_GPU_MEMORY_INFO_CURRENT_AVAILABLE_VIDMEM_NVX, &kibibytes);
    return int64_t{kibibytes} << 10;
  }
  if (!software && epoxy_has_gl_extension("GL_ATI_meminfo")) {
    GLint kibibytes[4] = {0, 0, 0, 0};
    glGetIntegerv(GL_TEXTURE_FREE_MEMORY_ATI, kibibytes);
    return int64_t{kibibytes[0]} << 10;
  }
  return machine_memory();
}

int32_t local_size() {
  return gpu::renders_in_software() ? 8 : 64;
}

std::string local_size_define(int32_t local_size) {
  return "LOCAL_SIZE " + std::to_string(local_size);
}

}  // namespace snowbough::snow
