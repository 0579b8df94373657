#pragma once

#include <string>
#include <string_view>

namespace snowbough::image {

/// Writes a file so that a reader sees either the old file or the complete new one: under a
/// temporary name in the same folder (`<name>.<process>.<number>.tmp`), which is flushed to the
/// disk and renamed. On failure the temporary file is removed and `path` is unchanged.
/// @throws std::runtime_error with the path and the system's reason (no such folder, no permission,
/// no space left), or if `path` is a device or a pipe.
void atomic_write(const std::string& path, std::string_view bytes);

/// The whole file. @throws std::runtime_error with the path and the system's reason, and for a
/// device or a pipe.
std::string read_file(const std::string& path);

}  // namespace snowbough::image
