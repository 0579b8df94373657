#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <string>
#include <vector>

#include "gpu/resources.h"

namespace snowbough::gpu {

/// Numbers of calls to OpenGL.
struct CallCounts {
  int64_t dispatches = 0;
  int64_t draws = 0;
};
/// The calls of all programs so far. GPU thread.
CallCounts call_counts();

/// A linked shader program whose inputs are set by name and checked by reflection: setting an input
/// that the program does not have is an error, and so is running it with an input that is not set.
/// Usage:
///
///   program.use();                         // forgets the bindings of the run before
///   program.set("pixel_size", 0.01f);      // uniforms keep their value from run to run
///   program.bind("TexelSteps", buffer);  // storage or uniform block, by block name
///   program.bind_image("height", texture, GL_READ_WRITE);
///   program.bind_texture("occlusion", texture);
///   program.dispatch(groups);              // or draw(...)
///
/// Shaders contain no `binding =`: units are numbered here.
class Program {
 public:
  /// `files` are names in shaders/, with the stage between the last dots ("stability.comp.glsl"):
  /// vert, tesc, tese, geom, frag or comp. `defines` apply to all of them.
  /// @throws std::runtime_error with the driver's log if compiling or linking fails.
  explicit Program(const std::vector<std::string>& files,
                   const std::vector<std::string>& defines = {});
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use();

  // All setters: @throws std::invalid_argument when the program has no such input.
  void set(const std::string& name, float value);
  void set(const std::string& name, int32_t value);
  void set(const std::string& name, uint32_t value);
  void set(const std::string& name, const glm::vec2& value);
  void set(const std::string& name, const glm::vec4& value);
  void set(const std::string& name, const glm::ivec2& value);
  void set(const std::string& name, const glm::uvec2& value);

  /// Binds a whole buffer, or `bytes` from `offset`, to a storage or uniform block.
  void bind(const std::string& block, const Buffer& buffer);
  void bind(const std::string& block, const Buffer& buffer, int64_t offset, int64_t bytes);
  void bind_texture(const std::string& sampler, const Texture& texture);
  void bind_texture(const std::string& sampler, const BufferTexture& texture);
  /// Binds mip level 0 of a texture, with all layers of an array, to an image.
  void bind_image(const std::string& image, const Texture& texture, GLenum access);

  /// Runs a compute program. @throws std::logic_error naming inputs that were not set.
  void dispatch(int32_t groups_x, int32_t groups_y = 1, int32_t groups_z = 1);
  /// Runs a compute program whose shader finds its item with item_index.h, in groups of
  /// `group_size`. Groups beyond one dimension's limit (`most_groups`; OpenGL guarantees 65,535) go
  /// into rows.
  void dispatch_items(int64_t count, int32_t group_size, int32_t most_groups = 65535);
  /// Runs a compute program with the group counts (three uint32) in the buffer, `offset` bytes from
  /// its start.
  void dispatch_indirect(const Buffer& groups, int64_t offset = 0);
  /// Draws `count` vertices with the bound vertex array, `instances` times. @throws as dispatch.
  void draw(GLenum mode, int32_t first, int32_t count, int32_t instances = 1);
  /// Draws `draws` times with the arguments in the buffer (four uint32 each: vertices, instances,
  /// first vertex, first instance), `offset` bytes from its start. @throws as dispatch.
  void draw_indirect(GLenum mode, const Buffer& arguments, int64_t offset = 0, int32_t draws = 1);

 private:
  enum class Kind { kUniform, kSampler, kImage, kStorage, kUniformBlock };
  struct Input {
    Kind kind = Kind::kUniform;
    GLint location = -1;
    GLuint unit = 0;
    bool ready = false;
  };

  void reflect();
  Input& find(const std::string& name, Kind kind, const char* what);
  void require_ready() const;

  GLuint id_ = 0;
  std::string name_;
  std::map<std::string, Input> inputs_;
};

/// ceil(count / size): the number of work groups that cover `count` items.
constexpr int32_t group_count(int64_t count, int32_t size) {
  return static_cast<int32_t>((count + size - 1) / size);
}

}  // namespace snowbough::gpu
