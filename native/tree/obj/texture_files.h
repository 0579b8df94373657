#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace snowbough::tree {

/// The file in `folder` with this relative path, whatever its case; empty if there is none.
std::filesystem::path find_below(const std::filesystem::path& folder,
                                 const std::filesystem::path& relative);

/// Whether a file, all links followed, lies below `root`; an empty root holds everything.
bool lies_below(const std::filesystem::path& root, const std::filesystem::path& file);

/// A texture's absolute path; empty if it is not found.
///
/// It is looked for at the path given, below each of the folders, and by its bare name in each, in
/// the folders for textures (textures, texture, maps, tex, images) in and above them, and in the
/// folders within those.
///
/// @param name  as a material names it.
/// @param root  what does not lie below it is not found; empty: everything may be.
std::string find_texture(const std::vector<std::filesystem::path>& folders, const std::string& name,
                         const std::filesystem::path& root = {});

/// The same of an image that has the texture's name but another ending: packs are converted and
/// their materials left as they were. Empty unless there is exactly one.
std::string find_converted_texture(const std::vector<std::filesystem::path>& folders,
                                   const std::string& name, const std::filesystem::path& root = {});

}  // namespace snowbough::tree
