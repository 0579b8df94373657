#include "image/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "base/file_path.h"
#include "image/open_file.h"

namespace snowbough::image {
namespace {

[[noreturn]] void fail(const char* action, const std::string& path, int error) {
  throw std::runtime_error(std::string("cannot ") + action + " '" + path +
                           "': " + std::generic_category().message(error));
}

/// Whether a pipe, a device or the like has this name, also behind a link: renaming would remove
/// it, and reading might never end.
bool is_special(const std::string& path) {
  std::error_code error;
  switch (std::filesystem::status(base::openable(base::as_path(path)), error).type()) {
    case std::filesystem::file_type::character:
    case std::filesystem::file_type::block:
    case std::filesystem::file_type::fifo:
    case std::filesystem::file_type::socket:
      return true;
    default:
      return false;
  }
}

std::string temporary_name(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  return path + "." + std::to_string(process_number()) + "." + std::to_string(counter++) + ".tmp";
}

/// A temporary file, which publish() gives its name; otherwise it is removed.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path)
      : path_(path), temporary_(temporary_name(path)), descriptor_(create_file(temporary_)) {
    if (descriptor_ < 0) fail("write", path_, errno);
  }
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile() {
    if (descriptor_ >= 0) close_file(descriptor_);
    if (!renamed_) remove_file(temporary_);
  }

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const int64_t written = write_some(descriptor_, bytes);
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail("write", path_, errno);
      // A full disk may also report 0 bytes written.
      if (written == 0) fail("write", path_, ENOSPC);
      bytes.remove_prefix(static_cast<size_t>(written));
    }
  }

  void publish() {
    if (!flush_file(descriptor_)) fail("write", path_, errno);
    const bool closed = close_file(descriptor_);
    descriptor_ = -1;
    // Network file systems may report a full disk only on close.
    if (!closed) fail("write", path_, errno);
    if (is_special(path_)) {
      throw std::runtime_error("cannot write '" + path_ + "': a device or a pipe has this name");
    }
    if (!rename_over(temporary_, path_)) fail("write", path_, errno);
    renamed_ = true;
  }

 private:
  std::string path_;
  std::string temporary_;
  int descriptor_;
  bool renamed_ = false;
};

}  // namespace

void atomic_write(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.publish();
}

std::string read_file(const std::string& path) {
  if (is_special(path)) throw std::runtime_error("cannot read '" + path + "': it is not a file");
  const int descriptor = open_file(path);
  if (descriptor < 0) fail("read", path, errno);
  std::string bytes;
  bytes.reserve(static_cast<size_t>(file_size(descriptor)));
  char block[1 << 16];
  while (true) {
    const int64_t count = read_some(descriptor, block, sizeof(block));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int error = errno;
      close_file(descriptor);
      fail("read", path, error);
    }
    if (count == 0) break;
    bytes.append(block, static_cast<size_t>(count));
  }
  close_file(descriptor);
  return bytes;
}

}  // namespace snowbough::image
