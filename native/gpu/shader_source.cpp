#include "gpu/shader_source.h"

#include <set>
#include <sstream>
#include <stdexcept>

namespace snowbough::gpu {
namespace {

const char* embedded_text(std::string_view name) {
  for (const EmbeddedShader* shader = kEmbeddedShaders; shader->name != nullptr; ++shader) {
    if (name == shader->name) {
      return shader->text;
    }
  }
  throw std::runtime_error("there is no shader file '" + std::string(name) + "'");
}

/// The file name of an `#include "file"` line, or empty.
std::string included_name(const std::string& line) {
  const size_t hash = line.find_first_not_of(" \t");
  if (hash == std::string::npos || line.compare(hash, 8, "#include") != 0) {
    return {};
  }
  const size_t open = line.find('"', hash);
  const size_t close = open == std::string::npos ? open : line.find('"', open + 1);
  if (close == std::string::npos) {
    return {};
  }
  const std::string path = line.substr(open + 1, close - open - 1);
  return path.substr(path.rfind('/') + 1);
}

void append_resolved(std::string_view name, std::set<std::string>& seen, std::string& version,
                     std::string& body) {
  if (!seen.insert(std::string(name)).second) {
    return;
  }
  std::istringstream text(embedded_text(name));
  for (std::string line; std::getline(text, line);) {
    const std::string include = included_name(line);
    if (!include.empty()) {
      append_resolved(include, seen, version, body);
    } else if (line.starts_with("#version")) {
      version = line;
    } else if (!line.starts_with("#pragma once")) {
      body += line + "\n";
    }
  }
}

}  // namespace

std::string shader_source(std::string_view name, const std::vector<std::string>& defines) {
  std::string version = "#version 450 core";
  std::string body;
  std::set<std::string> seen;
  append_resolved(name, seen, version, body);
  std::string head = version + "\n#define SNOWBOUGH_GLSL 1\n";
  for (const std::string& define : defines) {
    head += "#define " + define + "\n";
  }
  return head + body;
}

}  // namespace snowbough::gpu
