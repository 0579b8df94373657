#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace snowbough::gpu {

/// Bytes of all buffers that exist, without textures.
int64_t buffer_bytes();

// Owners of GL objects. All of their functions, destructors included, run on the GPU thread.

/// A GL name that is moved, never copied, and deleted once.
class Handle {
 public:
  Handle() = default;
  explicit Handle(GLuint id) : id_(id) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  GLuint id() const { return id_; }

 protected:
  GLuint id_ = 0;
};

/// A block of GPU memory.
class Buffer : public Handle {
 public:
  Buffer() = default;
  /// `bytes` of memory (at least 16 are allocated, so that an empty scene needs no special case),
  /// filled with zeros if `data` is null. @throws std::runtime_error if memory runs out.
  explicit Buffer(int64_t bytes, const void* data = nullptr);
  template <typename Element>
  explicit Buffer(const std::vector<Element>& elements)
      : Buffer(static_cast<int64_t>(elements.size() * sizeof(Element)), elements.data()) {}
  /// A buffer of undefined content. @throws as above.
  static Buffer unfilled(int64_t bytes);
  Buffer(Buffer&&) noexcept = default;
  Buffer& operator=(Buffer&&) noexcept = default;
  ~Buffer();

  int64_t bytes() const { return bytes_; }
  void write(int64_t offset, int64_t bytes, const void* data);
  void read(int64_t offset, int64_t bytes, void* data) const;
  /// Fills everything, or the first `bytes`, with zeros.
  void clear(int64_t bytes = -1);
  template <typename Element>
  std::vector<Element> read_all() const {
    std::vector<Element> elements(static_cast<size_t>(bytes_) / sizeof(Element));
    read(0, static_cast<int64_t>(elements.size() * sizeof(Element)), elements.data());
    return elements;
  }

 private:
  void allocate(const void* data);

  int64_t bytes_ = 0;
};

/// Mip levels of a texture down to one texel.
int32_t all_mip_levels(int32_t width, int32_t height);

/// A two-dimensional texture or array texture with nearest or linear filtering, clamped at its
/// edges. Reads and writes access mip level 0.
class Texture : public Handle {
 public:
  Texture() = default;
  /// `layers` 0 makes GL_TEXTURE_2D, 1 or more GL_TEXTURE_2D_ARRAY. Initially zero.
  /// `internal_format` is a sized format, e.g. GL_R32F.
  /// @throws std::runtime_error if memory runs out.
  Texture(GLenum internal_format, int32_t width, int32_t height, int32_t layers = 0,
          GLenum filter = GL_NEAREST, int32_t mip_levels = 1);
  Texture(Texture&&) noexcept = default;
  Texture& operator=(Texture&&) noexcept = default;
  ~Texture();

  GLenum format() const { return format_; }
  int32_t width() const { return width_; }
  int32_t height() const { return height_; }
  /// Number of layers; 0 when it is not an array.
  int32_t layers() const { return layers_; }
  /// Fills every texel with zeros.
  void clear();
  /// Copies one layer (0 for a plain texture) in or out, row 0 first, tightly packed. `format` and
  /// `type` describe the data in memory, e.g. GL_RED and GL_FLOAT.
  void write(int32_t layer, GLenum format, GLenum type, const void* data);
  /// The same for the `count` rows from `first` on.
  void write_rows(int32_t layer, int32_t first, int32_t count, GLenum format, GLenum type,
                  const void* data);
  void read(int32_t layer, GLenum format, GLenum type, int64_t bytes, void* data) const;
  /// Copies one layer to a buffer's beginning, on the GPU.
  void copy_to(int32_t layer, GLenum format, GLenum type, const Buffer& target) const;

 private:
  GLenum format_ = 0;
  int32_t width_ = 0;
  int32_t height_ = 0;
  int32_t layers_ = 0;
};

/// A buffer seen as a one-dimensional texture, for shaders of OpenGL 4.1.
class BufferTexture : public Handle {
 public:
  BufferTexture() = default;
  BufferTexture(const Buffer& buffer, GLenum internal_format);
  BufferTexture(BufferTexture&&) noexcept = default;
  BufferTexture& operator=(BufferTexture&&) noexcept = default;
  ~BufferTexture();
};

/// Render targets: colour textures and an optional depth texture. An array texture is attached with
/// all its layers, so that a geometry shader can select one with gl_Layer.
class Framebuffer : public Handle {
 public:
  Framebuffer() = default;
  /// @throws std::runtime_error if the driver refuses the combination.
  explicit Framebuffer(const std::vector<const Texture*>& colors, const Texture* depth = nullptr);
  Framebuffer(Framebuffer&&) noexcept = default;
  Framebuffer& operator=(Framebuffer&&) noexcept = default;
  ~Framebuffer();
};

/// An empty vertex array: the shaders fetch their vertices themselves.
class VertexArray : public Handle {
 public:
  VertexArray();
  VertexArray(VertexArray&&) noexcept = default;
  VertexArray& operator=(VertexArray&&) noexcept = default;
  ~VertexArray();
};

}  // namespace snowbough::gpu
