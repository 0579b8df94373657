#include "tree/obj/mtl_reader.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <string_view>

namespace snowbough::tree {
namespace {

namespace fs = std::filesystem;

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

std::string_view trim(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view next_token(std::string_view& rest) {
  rest = trim(rest);
  const size_t end = std::min(rest.find_first_of(" \t"), rest.size());
  const std::string_view token = rest.substr(0, end);
  rest.remove_prefix(end);
  return token;
}

std::optional<float> as_number(std::string_view token) {
  float value = 0.0f;
  const auto [stop, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error != std::errc() || stop != token.data() + token.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

/// The file's name behind the options of a texture statement (-s 1 1 1, -clamp on ...).
std::string texture_name(std::string_view rest) {
  rest = trim(rest);
  while (rest.starts_with('-')) {
    const std::string option = lower_case(next_token(rest));
    if (option == "-o" || option == "-s" || option == "-t") {
      // One to three numbers.
      for (int i = 0; i < 3; ++i) {
        std::string_view after = rest;
        if (!as_number(next_token(after))) break;
        rest = after;
      }
    } else {
      next_token(rest);
      if (option == "-mm") next_token(rest);
    }
    rest = trim(rest);
  }
  std::string name(rest);
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

/// The file in `folder` with this relative path, whatever its case; empty if there is none.
fs::path find_below(const fs::path& folder, const fs::path& relative) {
  std::error_code error;
  fs::path at = folder;
  for (const fs::path& step : relative) {
    if (fs::exists(at / step, error)) {
      at /= step;
      continue;
    }
    const std::string wanted = lower_case(step.string());
    fs::path found;
    for (const fs::directory_entry& entry : fs::directory_iterator(at, error)) {
      // The smallest of several that differ in case only: independent of the folder's order.
      const fs::path name = entry.path().filename();
      if (lower_case(name.string()) == wanted && (found.empty() || name < found)) found = name;
    }
    if (found.empty()) return {};
    at /= found;
  }
  return fs::is_regular_file(at, error) ? at : fs::path();
}

std::string find_texture(const fs::path& folder, const std::string& name) {
  const fs::path path(name);
  fs::path found =
      path.is_absolute() ? find_below("/", path.relative_path()) : find_below(folder, path);
  for (const char* subfolder : {"", "textures", "texture", "maps", "tex", "images"}) {
    if (!found.empty()) break;
    found = find_below(folder, fs::path(subfolder) / path.filename());
  }
  return found.empty() ? std::string() : fs::absolute(found).lexically_normal().string();
}

class MaterialReader {
 public:
  MaterialReader(std::map<std::string, FoliageMaterial>& materials,
                 std::vector<std::string>& warnings)
      : materials_(materials), warnings_(warnings) {}

  void read(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string line;
    current_ = nullptr;
    for (int number = 1; std::getline(stream, line); ++number) {
      place_ = file.filename().string() + ":" + std::to_string(number) + ": ";
      std::string_view rest(line);
      const std::string keyword = lower_case(next_token(rest));
      rest = trim(rest);
      if (keyword == "newmtl") {
        start_material(std::string(rest));
      } else if (current_ != nullptr) {
        read_statement(keyword, rest, file.parent_path());
      }
    }
  }

 private:
  void start_material(const std::string& name) {
    const auto [found, added] = materials_.try_emplace(name);
    found->second.name = name;
    current_ = added ? &found->second : nullptr;
  }

  void read_statement(const std::string& keyword, std::string_view rest, const fs::path& folder) {
    if (keyword == "kd") {
      glm::vec3 colour(0.0f);
      const std::optional<float> red = as_number(next_token(rest));
      if (!red) return malformed("Kd");
      colour = glm::vec3(*red);
      // Green and blue may be left out; they are then as red.
      for (int i = 1; i < 3 && !trim(rest).empty(); ++i) {
        const std::optional<float> value = as_number(next_token(rest));
        if (!value) return malformed("Kd");
        colour[i] = *value;
      }
      current_->diffuse = colour;
    } else if (keyword == "d" || keyword == "tr") {
      std::string_view token = next_token(rest);
      if (token == "-halo") token = next_token(rest);
      const std::optional<float> value = as_number(token);
      if (!value) return malformed(keyword);
      current_->opacity = std::clamp(keyword == "d" ? *value : 1.0f - *value, 0.0f, 1.0f);
    } else if (keyword == "map_kd") {
      current_->diffuse_texture = texture(rest, folder);
    } else if (keyword == "map_d" || keyword == "map_opacity") {
      current_->alpha_texture = texture(rest, folder);
    }
  }

  std::string texture(std::string_view rest, const fs::path& folder) {
    const std::string name = texture_name(rest);
    if (name.empty()) return {};
    std::string found = find_texture(folder, name);
    if (found.empty() && missing_.insert(name).second) {
      warnings_.push_back("texture '" + name + "' of material '" + current_->name + "' is missing");
    }
    return found;
  }

  void malformed(const std::string& what) {
    warnings_.push_back(place_ + "malformed " + what + " is ignored");
  }

  std::map<std::string, FoliageMaterial>& materials_;
  std::vector<std::string>& warnings_;
  FoliageMaterial* current_ = nullptr;
  std::string place_;
  std::set<std::string> missing_;
};

}  // namespace

std::map<std::string, FoliageMaterial> read_materials(const std::string& obj_path,
                                                      const std::vector<std::string>& libraries,
                                                      std::vector<std::string>& warnings) {
  std::map<std::string, FoliageMaterial> materials;
  MaterialReader reader(materials, warnings);
  fs::path folder = fs::path(obj_path).parent_path();
  if (folder.empty()) folder = ".";
  std::set<std::string> done;
  for (const std::string& library : libraries) {
    if (!done.insert(library).second) continue;
    std::string name = library;
    std::replace(name.begin(), name.end(), '\\', '/');
    fs::path file = find_below(folder, fs::path(name).relative_path());
    if (file.empty()) file = find_below(folder, fs::path(name).filename());
    if (!file.empty()) {
      reader.read(file);
      continue;
    }
    // One statement may name several libraries; names may hold blanks.
    std::string_view rest(library);
    bool any = false;
    while (!trim(rest).empty()) {
      const std::string_view token = next_token(rest);
      const fs::path part = token.empty() ? fs::path() : find_below(folder, fs::path(token));
      if (!part.empty()) {
        reader.read(part);
        any = true;
      }
    }
    if (!any) warnings.push_back("material library '" + library + "' is missing");
  }
  return materials;
}

}  // namespace snowbough::tree
