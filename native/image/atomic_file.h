#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace snowbough::image {

/// Writes `bytes` to `path` so that a reader sees either the old file or the whole new one: under a
/// temporary name in the same folder (`<name>.<process>.<number>.tmp`), flushed to the disk, then
/// renamed. On failure the temporary is removed and `path` is as it was.
/// @throws std::runtime_error with the path and the system's reason (no such folder, no permission,
///         no space left).
void atomic_write(const std::string& path, std::string_view bytes);

/// The whole file. @throws std::runtime_error with the path and the system's reason.
std::string read_file(const std::string& path);

}  // namespace snowbough::image
