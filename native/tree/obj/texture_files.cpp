#include "tree/obj/texture_files.h"

#include <algorithm>
#include <array>
#include <set>

#include "base/file_path.h"
#include "tree/obj/text.h"

namespace snowbough::tree {
namespace {

namespace fs = std::filesystem;

/// Usual names of texture folders.
constexpr std::array<const char*, 5> kTextureFolders = {"textures", "texture", "maps", "tex",
                                                        "images"};
/// Images that Blender reads.
constexpr std::array<const char*, 12> kImages = {".png", ".jpg", ".jpeg", ".tga",  ".tif", ".tiff",
                                                 ".bmp", ".dds", ".exr",  ".webp", ".jp2", ".hdr"};

/// The file or folder with this relative path in `folder`, ignoring case; empty if there is none.
fs::path find_any_below(const fs::path& folder, const fs::path& relative) {
  std::error_code error;
  fs::path at = folder;
  for (const fs::path& step : relative) {
    if (fs::exists(at / step, error)) {
      at /= step;
      continue;
    }
    const std::string wanted = lower_case(base::as_text(step));
    fs::path found;
    for (const fs::directory_entry& entry : fs::directory_iterator(at, error)) {
      // The smallest of several that differ only in case: independent of the folder's order.
      const fs::path name = entry.path().filename();
      if (lower_case(to_utf8(base::as_text(name))) == wanted && (found.empty() || name < found))
        found = name;
    }
    if (found.empty()) return {};
    at /= found;
  }
  return at;
}

bool is_inside(const fs::path& root, const fs::path& path) {
  return root.empty() ||
         std::mismatch(root.begin(), root.end(), path.begin(), path.end()).first == root.end();
}

/// The folders in a folder, sorted by name.
std::vector<fs::path> folders_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_directory(error)) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// The folders in which to search textures, the most likely first.
std::vector<fs::path> texture_folders(const std::vector<fs::path>& folders, const fs::path& path,
                                      const fs::path& root) {
  std::vector<fs::path> places;
  const auto add = [&](const fs::path& folder, const fs::path& relative) {
    std::error_code error;
    const fs::path found = find_any_below(folder, relative);
    if (fs::is_directory(found, error)) places.push_back(found);
  };
  // Paths outside may access another computer on the network.
  if (path.is_absolute() && is_inside(root, path.lexically_normal())) {
    add(path.root_path(), path.parent_path().relative_path());
  }
  for (const fs::path& folder : folders) {
    add(folder, path.parent_path().relative_path());
    add(folder, {});
    for (const char* beside : kTextureFolders) add(folder, beside);
  }
  for (const fs::path& folder : folders) {
    const fs::path above = fs::absolute(folder).parent_path();
    for (const char* beside : kTextureFolders) add(above, beside);
  }
  // Subfolders of a texture folder: Textures/Bark, say.
  for (const fs::path& folder : folders) {
    for (const fs::path& beside : folders_in(folder)) {
      const std::string called = lower_case(base::as_text(beside.filename()));
      const bool holds = std::find(kTextureFolders.begin(), kTextureFolders.end(), called) !=
                         kTextureFolders.end();
      if (!holds) continue;
      for (const fs::path& inner : folders_in(beside)) places.push_back(inner);
    }
  }
  return places;
}

std::string plain_path(const fs::path& path) {
  return base::as_text(fs::absolute(path).lexically_normal());
}

bool is_image(const fs::path& path) {
  const std::string ending = lower_case(base::as_text(path.extension()));
  return std::find(kImages.begin(), kImages.end(), ending) != kImages.end();
}

}  // namespace

fs::path find_below(const fs::path& folder, const fs::path& relative) {
  std::error_code error;
  const fs::path found = find_any_below(folder, relative);
  return fs::is_regular_file(found, error) ? found : fs::path();
}

bool lies_below(const fs::path& root, const fs::path& file) {
  if (root.empty()) return true;
  std::error_code error;
  const fs::path whole_root = fs::weakly_canonical(root, error);
  const fs::path whole = error ? fs::path() : fs::weakly_canonical(file, error);
  return !error && is_inside(whole_root, whole);
}

std::string find_texture(const std::vector<fs::path>& folders, const std::string& name,
                         const fs::path& root) {
  const fs::path path = base::as_path(name);
  for (const fs::path& folder : texture_folders(folders, path, root)) {
    const fs::path found = find_below(folder, path.filename());
    if (!found.empty() && lies_below(root, found)) return plain_path(found);
  }
  return {};
}

std::string find_converted_texture(const std::vector<fs::path>& folders, const std::string& name,
                                   const fs::path& root) {
  const fs::path path = base::as_path(name);
  const std::string stem = lower_case(base::as_text(path.stem()));
  std::set<std::string> found;
  for (const fs::path& folder : texture_folders(folders, path, root)) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
      const fs::path& file = entry.path();
      if (entry.is_regular_file(error) && is_image(file) && lies_below(root, file) &&
          lower_case(to_utf8(base::as_text(file.stem()))) == stem) {
        found.insert(plain_path(file));
      }
    }
  }
  return found.size() == 1 ? *found.begin() : std::string();
}

}  // namespace snowbough::tree
