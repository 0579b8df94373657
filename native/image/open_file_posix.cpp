#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>

#include "image/open_file.h"

namespace snowbough::image {

int create_file(const std::string& path) {
  return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
}

int open_file(const std::string& path) {
  return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
}

uint64_t file_size(int descriptor) {
  struct stat info {};
  return ::fstat(descriptor, &info) == 0 && info.st_size > 0 ? static_cast<uint64_t>(info.st_size)
                                                             : 0;
}

int64_t read_some(int descriptor, char* bytes, size_t count) {
  return ::read(descriptor, bytes, count);
}

int64_t write_some(int descriptor, std::string_view bytes) {
  return ::write(descriptor, bytes.data(), bytes.size());
}

bool flush_file(int descriptor) {
  return ::fsync(descriptor) == 0;
}

bool close_file(int descriptor) {
  return ::close(descriptor) == 0;
}

bool rename_over(const std::string& from, const std::string& to) {
  return std::rename(from.c_str(), to.c_str()) == 0;
}

void remove_file(const std::string& path) {
  ::unlink(path.c_str());
}

int process_number() {
  return ::getpid();
}

}  // namespace snowbough::image
