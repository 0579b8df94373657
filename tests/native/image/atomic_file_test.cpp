#include "image/atomic_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "image/open_file.h"
#include "native/image/temporary_folder.h"

namespace {
std::vector<std::string>& file_calls() {
  static std::vector<std::string> calls;
  return calls;
}
}  // namespace

// They replace the functions of the C library in this program.
extern "C" int fsync(int descriptor) {
  file_calls().push_back("fsync");
  return static_cast<int>(syscall(SYS_fsync, descriptor));
}
extern "C" int rename(const char* from, const char* to) noexcept {
  file_calls().push_back("rename");
  return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

namespace snowbough::image {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;
using AtomicFile = TemporaryFolder;

/// Lets files of this process grow to `bytes` only: a disk that fills up half-way.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SmallDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST_F(AtomicFile, atomicWriteLeavesExactlyTheBytes) {
  atomic_write(path("a.json"), "{\"a\": 1}");
  EXPECT_EQ(read_file(path("a.json")), "{\"a\": 1}");
  EXPECT_THAT(files(), ElementsAre("a.json"));
}

TEST_F(AtomicFile, atomicWriteReplacesAnOlderFile) {
  atomic_write(path("a"), "a long old text");
  atomic_write(path("a"), "new");
  EXPECT_EQ(read_file(path("a")), "new");
}

TEST_F(AtomicFile, aDiskThatFillsUpKeepsTheOldFileAndNoTemporary) {
  atomic_write(path("a"), "old");
  std::string message;
  {
    SmallDisk disk(1000);
    message = failure([&] { atomic_write(path("a"), std::string(5000, 'x')); });
  }
  EXPECT_THAT(message, HasSubstr(path("a")));
  EXPECT_THAT(message, HasSubstr("File too large"));
  EXPECT_EQ(read_file(path("a")), "old");
  EXPECT_THAT(files(), ElementsAre("a"));
}

TEST_F(AtomicFile, theBytesAreOnTheDiskBeforeTheFileHasItsName) {
  file_calls().clear();
  atomic_write(path("a"), "x");
  EXPECT_THAT(file_calls(), ElementsAre("fsync", "rename"));
}

TEST_F(AtomicFile, anExistingFileIsNotUsedAsTheTemporaryOne) {
  atomic_write(path("a.tmp"), "another one's");
  EXPECT_LT(create_file(path("a.tmp")), 0);
}

TEST_F(AtomicFile, aMissingFolderIsNamed) {
  const std::string message = failure([&] { atomic_write(path("no/a"), "x"); });
  EXPECT_THAT(message, HasSubstr(path("no/a")));
  EXPECT_THAT(message, HasSubstr("No such file or directory"));
}

TEST_F(AtomicFile, aPipeIsNeitherReplacedNorRead) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  fs::create_symlink(path("pipe"), path("link"));
  for (const char* name : {"pipe", "link"}) {
    EXPECT_THAT(failure([&] { atomic_write(path(name), "x"); }), HasSubstr("a device or a pipe"));
    EXPECT_THAT(failure([&] { read_file(path(name)); }), HasSubstr("it is not a file"));
  }
  EXPECT_TRUE(fs::is_fifo(path("pipe")));
  EXPECT_THAT(files(), ElementsAre("link", "pipe"));
}

TEST_F(AtomicFile, aFolderInTheWayIsReportedAndNoTemporaryStays) {
  fs::create_directory(folder_ / "taken");
  const std::string message = failure([&] { atomic_write(path("taken"), "x"); });
  EXPECT_THAT(message, HasSubstr("directory"));
  EXPECT_THAT(files(), ElementsAre("taken"));
}

}  // namespace
}  // namespace snowbough::image
