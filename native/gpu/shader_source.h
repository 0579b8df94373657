#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace snowbough::gpu {

/// A file of shaders/ or of a folder in it, compiled into the library.
struct EmbeddedShader {
  const char* name;
  const char* text;
};
/// All of them, then one whose name is null.
extern const EmbeddedShader kEmbeddedShaders[];

/// The source of shaders/<name> as the GL compiler takes it: the line `#version 450 core` (or the
/// file's own #version) first, then one `#define` a string of `defines` ("NAME" or "NAME value"),
/// then the text with every `#include "file"` replaced by that file, once each. Folders in its path
/// are for C++ compilers; files are told apart by their names alone.
/// @throws std::runtime_error naming a file that is not there.
std::string shader_source(std::string_view name, const std::vector<std::string>& defines = {});

}  // namespace snowbough::gpu
