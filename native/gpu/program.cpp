#include "gpu/program.h"

#include <stdexcept>

#include "gpu/shader_source.h"

namespace snowbough::gpu {
namespace {

thread_local CallCounts calls;

GLenum stage_of(const std::string& file) {
  static const std::map<std::string, GLenum> kStages = {
      {"vert", GL_VERTEX_SHADER},          {"tesc", GL_TESS_CONTROL_SHADER},
      {"tese", GL_TESS_EVALUATION_SHADER}, {"geom", GL_GEOMETRY_SHADER},
      {"frag", GL_FRAGMENT_SHADER},        {"comp", GL_COMPUTE_SHADER}};
  const size_t last = file.rfind('.');
  const size_t before = last == std::string::npos ? last : file.rfind('.', last - 1);
  const auto stage = before == std::string::npos
                         ? kStages.end()
                         : kStages.find(file.substr(before + 1, last - before - 1));
  if (stage == kStages.end()) {
    throw std::runtime_error("shader file '" + file + "' is not named <pass>.<stage>.glsl");
  }
  return stage->second;
}

GLuint compile(const std::string& file, const std::vector<std::string>& defines) {
  const GLuint shader = glCreateShader(stage_of(file));
  const std::string source = shader_source(file, defines);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (!compiled) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
    glDeleteShader(shader);
    throw std::runtime_error("shader " + file + " does not compile:\n" +
                             log.substr(0, static_cast<size_t>(length)));
  }
  return shader;
}

bool is_image(GLenum type) {
  return (type >= GL_IMAGE_1D && type <= GL_UNSIGNED_INT_IMAGE_2D_MULTISAMPLE_ARRAY);
}

bool is_sampler(GLenum type) {
  switch (type) {
    case GL_SAMPLER_2D:
    case GL_SAMPLER_2D_ARRAY:
    case GL_SAMPLER_3D:
    case GL_SAMPLER_CUBE:
    case GL_SAMPLER_2D_SHADOW:
    case GL_SAMPLER_BUFFER:
    case GL_INT_SAMPLER_2D:
    case GL_INT_SAMPLER_2D_ARRAY:
    case GL_INT_SAMPLER_BUFFER:
    case GL_UNSIGNED_INT_SAMPLER_2D:
    case GL_UNSIGNED_INT_SAMPLER_2D_ARRAY:
    case GL_UNSIGNED_INT_SAMPLER_BUFFER:
      return true;
    default:
      return false;
  }
}

std::string resource_name(GLuint program, GLenum interface, GLuint index) {
  char name[256];
  glGetProgramResourceName(program, interface, index, sizeof name, nullptr, name);
  std::string text = name;
  return text.ends_with("[0]") ? text.substr(0, text.size() - 3) : text;
}

}  // namespace

CallCounts call_counts() {
  return calls;
}

Program::Program(const std::vector<std::string>& files, const std::vector<std::string>& defines)
    : name_(files.empty() ? "" : files.front()) {
  std::vector<GLuint> shaders;
  try {
    for (const std::string& file : files) {
      shaders.push_back(compile(file, defines));
    }
  } catch (...) {
    for (const GLuint shader : shaders) {
      glDeleteShader(shader);
    }
    throw;
  }
  id_ = glCreateProgram();
  for (const GLuint shader : shaders) {
    glAttachShader(id_, shader);
  }
  glLinkProgram(id_);
  for (const GLuint shader : shaders) {
    glDetachShader(id_, shader);
    glDeleteShader(shader);
  }
  GLint linked = 0;
  glGetProgramiv(id_, GL_LINK_STATUS, &linked);
  if (!linked) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(id_, static_cast<GLsizei>(log.size()), &length, log.data());
    glDeleteProgram(id_);
    throw std::runtime_error("shader program " + name_ + " does not link:\n" +
                             log.substr(0, static_cast<size_t>(length)));
  }
  reflect();
}

Program::~Program() {
  glDeleteProgram(id_);
}

void Program::reflect() {
  GLint count = 0;
  GLuint sampler_unit = 0;
  GLuint image_unit = 0;
  glGetProgramInterfaceiv(id_, GL_UNIFORM, GL_ACTIVE_RESOURCES, &count);
  for (GLuint i = 0; i < static_cast<GLuint>(count); ++i) {
    const GLenum properties[] = {GL_TYPE, GL_LOCATION, GL_BLOCK_INDEX};
    GLint values[3] = {0, -1, -1};
    glGetProgramResourceiv(id_, GL_UNIFORM, i, 3, properties, 3, nullptr, values);
    if (values[2] >= 0 || values[1] < 0) {
      continue;  // members of uniform blocks, and the driver's own
    }
    Input input{Kind::kUniform, values[1]};
    if (is_sampler(static_cast<GLenum>(values[0]))) {
      input.kind = Kind::kSampler;
      input.unit = sampler_unit++;
      glProgramUniform1i(id_, input.location, static_cast<GLint>(input.unit));
    } else if (is_image(static_cast<GLenum>(values[0]))) {
      input.kind = Kind::kImage;
      input.unit = image_unit++;
      glProgramUniform1i(id_, input.location, static_cast<GLint>(input.unit));
    }
    inputs_[resource_name(id_, GL_UNIFORM, i)] = input;
  }
  glGetProgramInterfaceiv(id_, GL_SHADER_STORAGE_BLOCK, GL_ACTIVE_RESOURCES, &count);
  for (GLuint i = 0; i < static_cast<GLuint>(count); ++i) {
    glShaderStorageBlockBinding(id_, i, i);
    inputs_[resource_name(id_, GL_SHADER_STORAGE_BLOCK, i)] = {Kind::kStorage, -1, i};
  }
  glGetProgramInterfaceiv(id_, GL_UNIFORM_BLOCK, GL_ACTIVE_RESOURCES, &count);
  for (GLuint i = 0; i < static_cast<GLuint>(count); ++i) {
    glUniformBlockBinding(id_, i, i);
    inputs_[resource_name(id_, GL_UNIFORM_BLOCK, i)] = {Kind::kUniformBlock, -1, i};
  }
}

void Program::use() {
  glUseProgram(id_);
  for (auto& [name, input] : inputs_) {
    // Uniforms belong to the program and keep their value; bindings belong to the context.
    input.ready = input.ready && input.kind == Kind::kUniform;
  }
}

Program::Input& Program::find(const std::string& name, Kind kind, const char* what) {
  const auto input = inputs_.find(name);
  const bool is_block = kind == Kind::kStorage;
  if (input == inputs_.end() ||
      (input->second.kind != kind && !(is_block && input->second.kind == Kind::kUniformBlock))) {
    throw std::invalid_argument("shader program " + name_ + " uses no " + what + " named '" + name +
                                "'");
  }
  input->second.ready = true;
  return input->second;
}

void Program::set(const std::string& name, float value) {
  glProgramUniform1f(id_, find(name, Kind::kUniform, "uniform").location, value);
}
void Program::set(const std::string& name, int32_t value) {
  glProgramUniform1i(id_, find(name, Kind::kUniform, "uniform").location, value);
}
void Program::set(const std::string& name, uint32_t value) {
  glProgramUniform1ui(id_, find(name, Kind::kUniform, "uniform").location, value);
}
void Program::set(const std::string& name, const glm::vec2& value) {
  glProgramUniform2fv(id_, find(name, Kind::kUniform, "uniform").location, 1, &value.x);
}
void Program::set(const std::string& name, const glm::vec4& value) {
  glProgramUniform4fv(id_, find(name, Kind::kUniform, "uniform").location, 1, &value.x);
}
void Program::set(const std::string& name, const glm::ivec2& value) {
  glProgramUniform2iv(id_, find(name, Kind::kUniform, "uniform").location, 1, &value.x);
}
void Program::set(const std::string& name, const glm::uvec2& value) {
  glProgramUniform2uiv(id_, find(name, Kind::kUniform, "uniform").location, 1, &value.x);
}

void Program::bind(const std::string& block, const Buffer& buffer) {
  const Input& input = find(block, Kind::kStorage, "block");
  glBindBufferBase(input.kind == Kind::kStorage ? GL_SHADER_STORAGE_BUFFER : GL_UNIFORM_BUFFER,
                   input.unit, buffer.id());
}

void Program::bind(const std::string& block, const Buffer& buffer, int64_t offset, int64_t bytes) {
  const Input& input = find(block, Kind::kStorage, "block");
  glBindBufferRange(input.kind == Kind::kStorage ? GL_SHADER_STORAGE_BUFFER : GL_UNIFORM_BUFFER,
                    input.unit, buffer.id(), offset, bytes);
}

void Program::bind_texture(const std::string& sampler, const Texture& texture) {
  glBindTextureUnit(find(sampler, Kind::kSampler, "sampler").unit, texture.id());
}

void Program::bind_texture(const std::string& sampler, const BufferTexture& texture) {
  glBindTextureUnit(find(sampler, Kind::kSampler, "sampler").unit, texture.id());
}

void Program::bind_image(const std::string& image, const Texture& texture, GLenum access) {
  glBindImageTexture(find(image, Kind::kImage, "image").unit, texture.id(), 0, GL_TRUE, 0, access,
                     texture.format());
}

void Program::require_ready() const {
  for (const auto& [name, input] : inputs_) {
    if (!input.ready) {
      throw std::logic_error("shader program " + name_ + " runs without a value for its input '" +
                             name + "'");
    }
  }
}

void Program::dispatch(int32_t groups_x, int32_t groups_y, int32_t groups_z) {
  require_ready();
  if (groups_x > 0 && groups_y > 0 && groups_z > 0) {
    ++calls.dispatches;
    glDispatchCompute(static_cast<GLuint>(groups_x), static_cast<GLuint>(groups_y),
                      static_cast<GLuint>(groups_z));
  }
}

void Program::dispatch_items(int64_t count, int32_t group_size, int32_t most_groups) {
  const int32_t groups = group_count(count, group_size);
  const int32_t rows = group_count(groups, most_groups);
  dispatch(rows > 1 ? group_count(groups, rows) : groups, rows);
}

void Program::dispatch_indirect(const Buffer& groups, int64_t offset) {
  require_ready();
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, groups.id());
  ++calls.dispatches;
  glDispatchComputeIndirect(static_cast<GLintptr>(offset));
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, 0);
}

void Program::draw(GLenum mode, int32_t first, int32_t count, int32_t instances) {
  require_ready();
  if (count > 0 && instances > 0) {
    ++calls.draws;
    glDrawArraysInstanced(mode, first, count, instances);
  }
}

void Program::draw_indirect(GLenum mode, const Buffer& arguments, int64_t offset, int32_t draws) {
  require_ready();
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, arguments.id());
  ++calls.draws;
  glMultiDrawArraysIndirect(mode, reinterpret_cast<const void*>(static_cast<intptr_t>(offset)),
                            draws, 0);
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
}

}  // namespace snowbough::gpu
