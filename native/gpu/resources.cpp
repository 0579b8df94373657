#include "gpu/resources.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <stdexcept>

namespace snowbough::gpu {
namespace {

std::atomic<int64_t> held_bytes = 0;

/// Running out of memory depends on the user's scene, so its message gives advice.
void require_memory(int64_t bytes, const std::string& what) {
  const GLenum error = glGetError();
  if (error != GL_NO_ERROR) {
    throw std::runtime_error("the GPU has no room for " + what + " of " +
                             std::to_string(bytes >> 20) + " MiB (OpenGL error " +
                             std::to_string(error) +
                             "): use smaller maps, fewer receivers or a larger pixel_size");
  }
}

int64_t texel_bytes(GLenum format) {
  switch (format) {
    case GL_RGBA32F:
    case GL_RGBA32UI:
      return 16;
    case GL_RG32F:
    case GL_RG32UI:
    case GL_RGBA16F:
      return 8;
    default:
      return 4;
  }
}

}  // namespace

int64_t buffer_bytes() {
  return held_bytes;
}

void Buffer::allocate(const void* data) {
  glCreateBuffers(1, &id_);
  const int64_t room = std::max<int64_t>(bytes_, 16);
  glNamedBufferStorage(id_, room, bytes_ >= 16 ? data : nullptr, GL_DYNAMIC_STORAGE_BIT);
  const GLenum error = glGetError();
  if (error != GL_NO_ERROR) {
    glDeleteBuffers(1, &id_);
    throw std::runtime_error("the GPU has no room for a buffer of " + std::to_string(room >> 20) +
                             " MiB: use smaller maps, fewer receivers or a larger pixel_size");
  }
  held_bytes += room;
}

Buffer Buffer::unfilled(int64_t bytes) {
  Buffer buffer;
  buffer.bytes_ = bytes;
  buffer.allocate(nullptr);
  return buffer;
}

Buffer::Buffer(int64_t bytes, const void* data) : bytes_(bytes) {
  allocate(data);
  if (data == nullptr) {
    glClearNamedBufferData(id_, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  } else if (bytes > 0 && bytes < 16) {
    write(0, bytes, data);
  }
}

Buffer::~Buffer() {
  if (id_ != 0) {
    GLint64 room = 0;
    glGetNamedBufferParameteri64v(id_, GL_BUFFER_SIZE, &room);
    held_bytes -= room;
    glDeleteBuffers(1, &id_);
  }
}

void Buffer::write(int64_t offset, int64_t bytes, const void* data) {
  if (bytes > 0) {
    glNamedBufferSubData(id_, offset, bytes, data);
  }
}

void Buffer::read(int64_t offset, int64_t bytes, void* data) const {
  if (bytes > 0) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(id_, offset, bytes, data);
  }
}

void Buffer::clear(int64_t bytes) {
  if (bytes != 0) {
    glClearNamedBufferSubData(id_, GL_R32UI, 0, bytes < 0 ? (bytes_ + 3) / 4 * 4 : bytes,
                              GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  }
}

int32_t all_mip_levels(int32_t width, int32_t height) {
  return static_cast<int32_t>(std::bit_width(static_cast<uint32_t>(std::max(width, height))));
}

Texture::Texture(GLenum internal_format, int32_t width, int32_t height, int32_t layers,
                 GLenum filter, int32_t mip_levels)
    : format_(internal_format), width_(width), height_(height), layers_(layers) {
  glCreateTextures(layers == 0 ? GL_TEXTURE_2D : GL_TEXTURE_2D_ARRAY, 1, &id_);
  if (layers == 0) {
    glTextureStorage2D(id_, mip_levels, internal_format, width, height);
  } else {
    glTextureStorage3D(id_, mip_levels, internal_format, width, height, layers);
  }
  try {
    require_memory(texel_bytes(internal_format) * width * height * std::max(layers, 1),
                   "a texture");
  } catch (...) {
    glDeleteTextures(1, &id_);
    throw;
  }
  const auto minify = static_cast<GLint>(filter);
  glTextureParameteri(id_, GL_TEXTURE_MIN_FILTER, minify);
  glTextureParameteri(id_, GL_TEXTURE_MAG_FILTER, minify);
  glTextureParameteri(id_, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(id_, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  clear();
}

Texture::~Texture() {
  if (id_ != 0) {
    glDeleteTextures(1, &id_);
  }
}

namespace {

/// Format and type for glClearTexImage with a null value: integer textures need integer formats.
std::pair<GLenum, GLenum> clear_format(GLenum internal_format) {
  switch (internal_format) {
    case GL_R8UI:
    case GL_R16UI:
    case GL_R32UI:
    case GL_RG32UI:
    case GL_RGBA32UI:
      return {GL_RED_INTEGER, GL_UNSIGNED_INT};
    case GL_R32I:
    case GL_RG32I:
      return {GL_RED_INTEGER, GL_INT};
    case GL_DEPTH_COMPONENT32F:
    case GL_DEPTH_COMPONENT24:
      return {GL_DEPTH_COMPONENT, GL_FLOAT};
    default:
      return {GL_RED, GL_FLOAT};
  }
}

}  // namespace

void Texture::clear() {
  const auto [format, type] = clear_format(format_);
  glClearTexImage(id_, 0, format, type, nullptr);
}

void Texture::write(int32_t layer, GLenum format, GLenum type, const void* data) {
  write_rows(layer, 0, height_, format, type, data);
}

void Texture::write_rows(int32_t layer, int32_t first, int32_t count, GLenum format, GLenum type,
                         const void* data) {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (layers_ == 0) {
    glTextureSubImage2D(id_, 0, 0, first, width_, count, format, type, data);
  } else {
    glTextureSubImage3D(id_, 0, 0, first, layer, width_, count, 1, format, type, data);
  }
}

void Texture::read(int32_t layer, GLenum format, GLenum type, int64_t bytes, void* data) const {
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureSubImage(id_, 0, 0, 0, layer, width_, height_, 1, format, type,
                       static_cast<GLsizei>(bytes), data);
}

void Texture::copy_to(int32_t layer, GLenum format, GLenum type, const Buffer& target) const {
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, target.id());
  glGetTextureSubImage(id_, 0, 0, 0, layer, width_, height_, 1, format, type,
                       static_cast<GLsizei>(target.bytes()), nullptr);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

BufferTexture::BufferTexture(const Buffer& buffer, GLenum internal_format) {
  glCreateTextures(GL_TEXTURE_BUFFER, 1, &id_);
  glTextureBuffer(id_, internal_format, buffer.id());
}

BufferTexture::~BufferTexture() {
  if (id_ != 0) {
    glDeleteTextures(1, &id_);
  }
}

Framebuffer::Framebuffer(const std::vector<const Texture*>& colors, const Texture* depth) {
  glCreateFramebuffers(1, &id_);
  std::vector<GLenum> targets;
  for (size_t i = 0; i < colors.size(); ++i) {
    targets.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i));
    glNamedFramebufferTexture(id_, targets.back(), colors[i]->id(), 0);
  }
  if (depth != nullptr) {
    glNamedFramebufferTexture(id_, GL_DEPTH_ATTACHMENT, depth->id(), 0);
  }
  glNamedFramebufferDrawBuffers(id_, static_cast<GLsizei>(targets.size()), targets.data());
  const GLenum status = glCheckNamedFramebufferStatus(id_, GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    glDeleteFramebuffers(1, &id_);
    throw std::runtime_error("the driver refuses a framebuffer (status " + std::to_string(status) +
                             "): try another device with SNOWBOUGH_EGL_DEVICE");
  }
}

Framebuffer::~Framebuffer() {
  if (id_ != 0) {
    glDeleteFramebuffers(1, &id_);
  }
}

VertexArray::VertexArray() {
  glCreateVertexArrays(1, &id_);
}

VertexArray::~VertexArray() {
  if (id_ != 0) {
    glDeleteVertexArrays(1, &id_);
  }
}

}  // namespace snowbough::gpu
