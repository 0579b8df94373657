#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace snowbough::image {

/// Writes a file so that a reader sees either the old one or the whole new one: under a temporary
/// name in the same folder (`<name>.<process>.<number>.tmp`), flushed to the disk and renamed by
/// publish(). Without that, and on failure, the temporary is removed and `path` is as it was.
/// @throws std::runtime_error, from all functions, with the path and the system's reason (no such
///         folder, no permission, no space left).
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// Appends.
  void write(std::string_view bytes);
  /// Replaces bytes that are there already.
  void overwrite(uint64_t offset, std::string_view bytes);
  void publish();

 private:
  std::string path_;
  std::string temporary_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

/// Writes `bytes` as a whole AtomicFile.
void atomic_write(const std::string& path, std::string_view bytes);

/// The whole file. @throws std::runtime_error with the path and the system's reason.
std::string read_file(const std::string& path);

}  // namespace snowbough::image
