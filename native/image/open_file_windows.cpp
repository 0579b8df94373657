#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <thread>

#define NOMINMAX
#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#include "base/file_path.h"
#include "image/open_file.h"

namespace snowbough::image {
namespace {

constexpr size_t kMaxAtOnce = size_t{1} << 30;

std::wstring wide(const std::string& path) {
  return base::openable(base::as_path(path)).native();
}

/// Readers, indexers and virus scanners keep files open for a short time.
bool is_held(DWORD error) {
  return error == ERROR_SHARING_VIOLATION || error == ERROR_ACCESS_DENIED ||
         error == ERROR_LOCK_VIOLATION;
}

int as_errno(DWORD error) {
  switch (error) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
      return ENOENT;
    case ERROR_DISK_FULL:
    case ERROR_HANDLE_DISK_FULL:
      return ENOSPC;
    default:
      return is_held(error) ? EACCES : EIO;
  }
}

}  // namespace

int create_file(const std::string& path) {
  return ::_wopen(wide(path).c_str(), _O_WRONLY | _O_CREAT | _O_EXCL | _O_BINARY | _O_NOINHERIT,
                  _S_IREAD | _S_IWRITE);
}

int open_file(const std::string& path) {
  return ::_wopen(wide(path).c_str(), _O_RDONLY | _O_BINARY | _O_NOINHERIT);
}

uint64_t file_size(int descriptor) {
  return static_cast<uint64_t>(std::max<int64_t>(::_filelengthi64(descriptor), 0));
}

int64_t read_some(int descriptor, char* bytes, size_t count) {
  return ::_read(descriptor, bytes, static_cast<unsigned>(std::min(count, kMaxAtOnce)));
}

int64_t write_some(int descriptor, std::string_view bytes) {
  return ::_write(descriptor, bytes.data(),
                  static_cast<unsigned>(std::min(bytes.size(), kMaxAtOnce)));
}

bool flush_file(int descriptor) {
  return ::_commit(descriptor) == 0;
}

bool close_file(int descriptor) {
  return ::_close(descriptor) == 0;
}

bool rename_over(const std::string& from, const std::string& to) {
  const std::wstring source = wide(from);
  const std::wstring target = wide(to);
  DWORD error = 0;
  for (int wait_ms = 1; wait_ms < 2000; wait_ms *= 2) {
    if (::MoveFileExW(source.c_str(), target.c_str(),
                      MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH)) {
      return true;
    }
    error = ::GetLastError();
    if (!is_held(error)) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
  }
  errno = as_errno(error);
  return false;
}

void remove_file(const std::string& path) {
  ::DeleteFileW(wide(path).c_str());
}

int process_number() {
  return ::_getpid();
}

}  // namespace snowbough::image
