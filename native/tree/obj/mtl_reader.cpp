#include "tree/obj/mtl_reader.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>

#include "base/file_path.h"
#include "tree/obj/text.h"
#include "tree/obj/texture_files.h"

namespace snowbough::tree {
namespace {

namespace fs = std::filesystem;

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

/// A texture statement: the file name after its options (-s 1 1 1, -clamp on ...).
struct TextureStatement {
  std::string name;
  glm::vec2 scale{1.0f}, offset{0.0f};
  std::optional<float> bump;
};

TextureStatement read_texture_statement(std::string_view rest) {
  TextureStatement statement;
  rest = trim(rest);
  while (rest.starts_with('-')) {
    const std::string option = lower_case(next_token(rest));
    if (option == "-o" || option == "-s" || option == "-t") {
      // One to three numbers; surface textures use the first two.
      for (int i = 0; i < 3; ++i) {
        std::string_view after = rest;
        const std::optional<float> value = as_number(next_token(after));
        if (!value) break;
        rest = after;
        if (i < 2 && option == "-o") statement.offset[i] = *value;
        if (i < 2 && option == "-s") statement.scale[i] = *value;
      }
    } else {
      const std::optional<float> value = as_number(next_token(rest));
      if (option == "-bm") statement.bump = value;
      if (option == "-mm") next_token(rest);
    }
    rest = trim(rest);
  }
  // Some exporters quote names with blanks.
  if (rest.size() > 1 && rest.front() == '"' && rest.back() == '"') {
    rest = rest.substr(1, rest.size() - 2);
  }
  statement.name = to_utf8(rest);
  std::replace(statement.name.begin(), statement.name.end(), '\\', '/');
  return statement;
}

/// Text after "is missing" for a name outside the allowed folders.
std::string where_it_may_be(const fs::path& root, const std::string& name) {
  const fs::path path = base::as_path(name);
  const bool leads_out =
      path.is_absolute() || std::find(path.begin(), path.end(), fs::path("..")) != path.end();
  if (root.empty() || !leads_out) return "";
  return " below " + base::as_text(root) + " (files elsewhere are only read with outside_files)";
}

/// Whether one of a file name's words marks a normal map, or its last one is n.
bool is_normal_map(const std::string& path) {
  const std::string stem = lower_case(base::as_text(base::as_path(path).stem())) + ".";
  if (stem.size() > 2 && (stem.ends_with("_n.") || stem.ends_with("-n."))) return true;
  std::string word;
  for (const char c : stem) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      word += c;
      continue;
    }
    if (word == "normal" || word == "normals" || word == "nrm" || word == "nor" || word == "norm" ||
        word == "normalmap") {
      return true;
    }
    word.clear();
  }
  return false;
}

class MaterialReader {
 public:
  /// @param obj_folder where the OBJ file is.
  /// @param root files outside of it are not read; empty: no restriction.
  MaterialReader(fs::path obj_folder, fs::path root, const std::set<std::string>& used,
                 std::map<std::string, ObjMaterial>& materials, std::vector<std::string>& warnings)
      : obj_folder_(std::move(obj_folder)),
        root_(std::move(root)),
        used_(used),
        materials_(materials),
        warnings_(warnings) {}

  void read(const fs::path& file) {
    std::ifstream bytes(base::openable(file), std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(bytes), {}};
    end_lines_by_newline(text.data(), text.data() + text.size());
    std::istringstream stream(std::move(text));
    std::string line;
    current_ = nullptr;
    for (int number = 1; std::getline(stream, line); ++number) {
      place_ = base::as_text(file.filename()) + ":" + std::to_string(number) + ": ";
      std::string_view rest(line);
      const std::string keyword = lower_case(next_token(rest));
      rest = trim(rest);
      if (keyword == "newmtl") {
        start_material(to_utf8(rest));
      } else if (current_ != nullptr) {
        read_statement(keyword, rest, file.parent_path());
      }
    }
  }

 private:
  void start_material(const std::string& name) {
    current_ = nullptr;
    if (!used_.contains(name)) return;
    const auto [found, added] = materials_.try_emplace(name);
    found->second.name = name;
    found->second.defined = true;
    current_ = added ? &found->second : nullptr;
  }

  void read_statement(const std::string& keyword, std::string_view rest, const fs::path& folder) {
    if (keyword == "kd") {
      read_colour("Kd", rest, current_->diffuse);
    } else if (keyword == "tf") {
      // The alternatives `Tf spectral` and `Tf xyz` are not used in practice.
      if (as_number(std::string_view(rest.substr(0, rest.find_first_of(" \t")))))
        read_colour("Tf", rest, current_->transmission);
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
    } else if (keyword == "map_ks") {
      current_->specular_texture = texture(rest, folder);
    } else if (keyword == "norm" || keyword == "map_kn") {
      current_->normal_texture = texture(rest, folder);
    } else if (keyword == "map_bump" || keyword == "bump") {
      const MaterialTexture found = texture(rest, folder);
      (is_normal_map(found.path) ? current_->normal_texture : current_->bump_texture) = found;
      current_->bump_strength = read_texture_statement(rest).bump.value_or(1.0f);
    }
  }

  /// Missing green and blue equal red.
  void read_colour(const std::string& what, std::string_view rest, glm::vec3& colour) {
    glm::vec3 values(0.0f);
    for (int i = 0; i < 3; ++i) {
      if (i > 0 && trim(rest).empty()) {
        values[i] = values[0];
        continue;
      }
      const std::optional<float> value = as_number(next_token(rest));
      if (!value) return malformed(what);
      values[i] = *value;
    }
    colour = values;
  }

  MaterialTexture texture(std::string_view rest, const fs::path& folder) {
    const TextureStatement statement = read_texture_statement(rest);
    if (statement.name.empty()) return {};
    const std::vector<fs::path> folders = {folder, obj_folder_};
    MaterialTexture found{find_texture(folders, statement.name, root_), statement.scale,
                          statement.offset};
    if (!found.path.empty()) return found;
    found.path = find_converted_texture(folders, statement.name, root_);
    // A missing file is reported once, independent of path and case.
    if (missing_.insert(lower_case(base::as_text(base::as_path(statement.name).filename())))
            .second) {
      const std::string instead = base::as_text(base::as_path(found.path).filename());
      warnings_.push_back("texture '" + statement.name + "' of material '" + current_->name +
                          "' is missing" + where_it_may_be(root_, statement.name) +
                          (found.path.empty() ? "" : ": '" + instead + "' is used instead"));
    }
    return found;
  }

  void malformed(const std::string& what) {
    warnings_.push_back(place_ + "malformed " + what + " ignored");
  }

  fs::path obj_folder_;
  fs::path root_;
  const std::set<std::string>& used_;
  std::map<std::string, ObjMaterial>& materials_;
  std::vector<std::string>& warnings_;
  ObjMaterial* current_ = nullptr;
  std::string place_;
  std::set<std::string> missing_;
};

/// The parent of an OBJ file's folder, where packs keep textures; never the file system's root.
fs::path folder_to_stay_in(const fs::path& folder) {
  fs::path own = fs::absolute(folder).lexically_normal();
  if (!own.has_filename()) own = own.parent_path();
  const fs::path above = own.parent_path();
  return above == above.root_path() ? own : above;
}

/// The files of a statement `mtllib`: it may list several, and names may contain blanks.
std::vector<fs::path> find_libraries(const fs::path& folder, const fs::path& root,
                                     const std::string& statement) {
  std::string name = statement;
  std::replace(name.begin(), name.end(), '\\', '/');
  const auto find = [&](const fs::path& relative) {
    const fs::path found = find_below(folder, relative);
    return found.empty() || !lies_below(root, found) ? fs::path() : found;
  };
  fs::path file = find(base::as_path(name).relative_path());
  if (file.empty()) file = find(base::as_path(name).filename());
  if (!file.empty()) return {file};
  std::vector<fs::path> files;
  std::string_view rest(statement);
  while (!trim(rest).empty()) {
    const std::string_view token = next_token(rest);
    file = token.empty() ? fs::path() : find(base::as_path(token));
    if (!file.empty()) files.push_back(file);
  }
  return files;
}

}  // namespace

std::map<std::string, ObjMaterial> read_materials(const std::string& obj_path,
                                                  const std::vector<std::string>& libraries,
                                                  const std::set<std::string>& used,
                                                  bool outside_files,
                                                  std::vector<std::string>& warnings) {
  std::map<std::string, ObjMaterial> materials;
  fs::path folder = base::as_path(obj_path).parent_path();
  if (folder.empty()) folder = ".";
  const fs::path root = outside_files ? fs::path() : folder_to_stay_in(folder);
  MaterialReader reader(folder, root, used, materials, warnings);
  std::set<std::string> done;
  std::vector<std::string> missing;
  bool any = false;
  for (const std::string& library : libraries) {
    if (!done.insert(library).second) continue;
    const std::vector<fs::path> files = find_libraries(folder, root, library);
    for (const fs::path& file : files) reader.read(file);
    any = any || !files.empty();
    if (files.empty()) missing.push_back(library);
  }
  // The OBJ was renamed, or does not name its library.
  fs::path own;
  if (!any) own = find_below(folder, base::as_path(obj_path).stem().concat(".mtl"));
  if (!own.empty() && lies_below(root, own)) {
    reader.read(own);
    return materials;
  }
  for (const std::string& library : missing) {
    warnings.push_back("material library '" + library + "' is missing" +
                       where_it_may_be(root, library));
  }
  return materials;
}

}  // namespace snowbough::tree
