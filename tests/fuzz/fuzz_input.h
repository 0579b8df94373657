#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

// Shared by the fuzzers: typed values from the fuzzer's bytes, a folder for readers of files, and
// the check of a fuzzer.
namespace snowbough::fuzz {

/// Ends the program with a message, which libFuzzer reports as a crash.
inline void require(bool holds, const char* message) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: %s\n", message);
  std::abort();
}

/// Takes values from the fuzzer's bytes; 0 after their end.
class Input {
 public:
  Input(const uint8_t* data, size_t size) : rest_(reinterpret_cast<const char*>(data), size) {}

  template <typename T>
  T take() {
    T value{};
    std::memcpy(&value, rest_.data(), std::min(sizeof value, rest_.size()));
    rest_.remove_prefix(std::min(sizeof value, rest_.size()));
    return value;
  }
  /// A number from `low` to `high`, of one byte.
  int32_t range(int32_t low, int32_t high) { return low + take<uint8_t>() % (high - low + 1); }
  std::string_view bytes(size_t count) {
    const std::string_view part = rest_.substr(0, std::min(count, rest_.size()));
    rest_.remove_prefix(part.size());
    return part;
  }
  std::string_view rest() const { return rest_; }
  bool empty() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

/// A folder in memory, deleted at exit.
class ScratchFolder {
 public:
  ScratchFolder() {
    namespace fs = std::filesystem;
    const fs::path memory = "/dev/shm";
    path_ = (fs::is_directory(memory) ? memory : fs::temp_directory_path()) /
            ("snowbough-fuzz-" + std::to_string(getpid()));
    fs::create_directories(path_);
  }
  ~ScratchFolder() { std::filesystem::remove_all(path_); }

  std::string file(const std::string& name) const { return (path_ / name).string(); }
  /// Writes a file, and its folders, and returns its path.
  std::string write(const std::string& name, std::string_view bytes) const {
    const std::filesystem::path path = path_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path.string();
  }

 private:
  std::filesystem::path path_;
};

}  // namespace snowbough::fuzz
