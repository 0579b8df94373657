#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace snowbough::tree {

/// The file with this relative path in `folder`, ignoring case; empty if there is none.
std::filesystem::path find_below(const std::filesystem::path& folder,
                                 const std::filesystem::path& relative);

/// Whether a file, after resolving links, is below `root`; an empty root contains everything.
bool lies_below(const std::filesystem::path& root, const std::filesystem::path& file);

/// A texture's absolute path; empty if it is not found.
///
/// Searches the given path, below each of the folders, then the file name in each folder, in the
/// texture folders (textures, texture, maps, tex, images) in and above them, and in the subfolders
/// of those.
///
/// @param name  as in the material.
/// @param root  files outside of it are ignored; empty: no restriction.
std::string find_texture(const std::vector<std::filesystem::path>& folders, const std::string& name,
                         const std::filesystem::path& root = {});

/// The same for an image with the texture's name and another extension: texture packs are often
/// converted without updating the materials. Empty unless there is exactly one.
std::string find_converted_texture(const std::vector<std::filesystem::path>& folders,
                                   const std::string& name, const std::filesystem::path& root = {});

}  // namespace snowbough::tree
