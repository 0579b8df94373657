#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace snowbough::image {

/// Writes a file so that a reader sees either the old file or the complete new one: under a
/// temporary name in the same folder (`<name>.<process>.<number>.tmp`), which publish() flushes to
/// the disk and renames. Without publish(), and on failure, the temporary file is removed and
/// `path` is unchanged.
/// @throws std::runtime_error, from all functions, with the path and the system's reason (no such
/// folder, no permission, no space left), or if `path` is a device or a pipe.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// Appends.
  void write(std::string_view bytes);
  /// Replaces bytes that are already written.
  void overwrite(uint64_t offset, std::string_view bytes);
  void publish();

 private:
  std::string path_;
  std::string temporary_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

/// Writes `bytes` through an AtomicFile.
void atomic_write(const std::string& path, std::string_view bytes);

/// The whole file. @throws std::runtime_error with the path and the system's reason, and for a
/// device or a pipe.
std::string read_file(const std::string& path);

}  // namespace snowbough::image
