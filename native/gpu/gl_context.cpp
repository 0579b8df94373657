#include "gpu/gl_context.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <limits>

namespace snowbough::gpu {
namespace {

std::string gl_string(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text == nullptr ? "" : text;
}

}  // namespace

GpuInfo read_info(const std::string& device) {
  GpuInfo info{gl_string(GL_VENDOR), gl_string(GL_RENDERER), gl_string(GL_VERSION), device};
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &info.max_array_layers);
  GLint64 bytes = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
  info.max_storage_buffer_bytes = bytes;
  return info;
}

int32_t storage_blocks() {
  GLint fewest = std::numeric_limits<GLint>::max();
  for (const GLenum stage :
       {GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS,
        GL_MAX_TESS_CONTROL_SHADER_STORAGE_BLOCKS, GL_MAX_TESS_EVALUATION_SHADER_STORAGE_BLOCKS,
        GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS}) {
    GLint blocks = 0;
    glGetIntegerv(stage, &blocks);
    fewest = std::min(fewest, blocks);
  }
  return fewest;
}

bool is_software(std::string_view renderer) {
  return renderer.find("llvmpipe") != std::string_view::npos ||
         renderer.find("softpipe") != std::string_view::npos;
}

bool renders_in_software() {
  return is_software(gl_string(GL_RENDERER));
}

}  // namespace snowbough::gpu
