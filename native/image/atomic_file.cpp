#include "image/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <system_error>

namespace snowbough::image {
namespace {

[[noreturn]] void fail(const char* action, const std::string& path, int error) {
  throw std::runtime_error(std::string("cannot ") + action + " '" + path +
                           "': " + std::generic_category().message(error));
}

/// A file descriptor and, until `keep`, the temporary file behind it.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& path, const std::string& temporary)
      : path_(path), temporary_(temporary) {
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail("write", path_, errno);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!renamed_) ::unlink(temporary_.c_str());
  }

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail("write", path_, errno);
      // A full disk may also show as nothing written.
      if (written == 0) fail("write", path_, ENOSPC);
      bytes.remove_prefix(static_cast<size_t>(written));
    }
  }

  void publish() {
    if (::fsync(descriptor_) != 0) fail("write", path_, errno);
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    // Network file systems report a full disk as late as here.
    if (closed != 0) fail("write", path_, errno);
    if (std::rename(temporary_.c_str(), path_.c_str()) != 0) fail("write", path_, errno);
    renamed_ = true;
  }

 private:
  std::string path_;
  std::string temporary_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

std::string temporary_name(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  return path + "." + std::to_string(::getpid()) + "." + std::to_string(counter++) + ".tmp";
}

}  // namespace

void atomic_write(const std::string& path, std::string_view bytes) {
  TemporaryFile file(path, temporary_name(path));
  file.write(bytes);
  file.publish();
}

std::string read_file(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail("read", path, errno);
  std::string bytes;
  struct stat info {};
  if (::fstat(descriptor, &info) == 0 && info.st_size > 0) {
    bytes.reserve(static_cast<size_t>(info.st_size));
  }
  char block[1 << 16];
  while (true) {
    const ssize_t count = ::read(descriptor, block, sizeof(block));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int error = errno;
      ::close(descriptor);
      fail("read", path, error);
    }
    if (count == 0) break;
    bytes.append(block, static_cast<size_t>(count));
  }
  ::close(descriptor);
  return bytes;
}

}  // namespace snowbough::image
