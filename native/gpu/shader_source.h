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
/// All files, terminated by an entry with a null name.
extern const EmbeddedShader kEmbeddedShaders[];

/// The source of shaders/<name> for the GL compiler: the line `#version 450 core` (or the file's
/// own #version) first, then one `#define` per string of `defines` ("NAME" or "NAME value"), then
/// the text with every `#include "file"` replaced by that file, once each. Folders in an include
/// path are for C++ compilers; only file names identify files.
/// @throws std::runtime_error naming a file that does not exist.
std::string shader_source(std::string_view name, const std::vector<std::string>& defines = {});

}  // namespace snowbough::gpu
