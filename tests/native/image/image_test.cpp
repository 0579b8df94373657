#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <random>

#include "image/atomic_file.h"
#include "image/exr.h"
#include "image/png.h"

namespace snowbough::image {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A folder of its own per test, removed afterwards.
class Image : public ::testing::Test {
 protected:
  Image() {
    folder_ = fs::temp_directory_path() /
              ("snowbough_image_" + std::to_string(::getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  ~Image() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_))
      names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }

  fs::path folder_;
};

template <typename Call>
std::string failure(Call call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no failure";
}

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

TEST_F(Image, atomicWriteLeavesExactlyTheBytes) {
  atomic_write(path("a.json"), "{\"a\": 1}");
  EXPECT_EQ(read_file(path("a.json")), "{\"a\": 1}");
  EXPECT_THAT(files(), ElementsAre("a.json"));
}

TEST_F(Image, atomicWriteReplacesAnOlderFile) {
  atomic_write(path("a"), "a long old text");
  atomic_write(path("a"), "new");
  EXPECT_EQ(read_file(path("a")), "new");
}

TEST_F(Image, aDiskThatFillsUpKeepsTheOldFileAndNoTemporary) {
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

TEST_F(Image, aMissingFolderIsNamed) {
  const std::string message = failure([&] { atomic_write(path("no/a"), "x"); });
  EXPECT_THAT(message, HasSubstr(path("no/a")));
  EXPECT_THAT(message, HasSubstr("No such file or directory"));
}

TEST_F(Image, aFolderInTheWayIsReportedAndNoTemporaryStays) {
  fs::create_directory(folder_ / "taken");
  const std::string message = failure([&] { atomic_write(path("taken"), "x"); });
  EXPECT_THAT(message, HasSubstr("directory"));
  EXPECT_THAT(files(), ElementsAre("taken"));
}

TEST_F(Image, heightsComeBackBitForBit) {
  const std::vector<float> height{0.0f, 1e-30f, 0.1f,  1.0f / 3.0f, 123.456f,
                                  7e7f, 0.25f,  -0.0f, 2.5e-7f};
  write_height_exr(path("h.exr"), 3, height.data(), {{"snowboughUnit", "metre"}});
  const ExrImage image = read_exr(path("h.exr"));
  EXPECT_EQ(image.layout.width, 3);
  EXPECT_EQ(image.layout.height, 3);
  EXPECT_THAT(image.layout.channels, ElementsAre("Y"));
  EXPECT_EQ(image.layout.type, ExrPixelType::kFloat);
  EXPECT_EQ(image.layout.attributes.at("snowboughUnit"), "metre");
  EXPECT_EQ(0, std::memcmp(image.pixels.data(), height.data(), sizeof(float) * 9));
}

TEST_F(Image, rowZeroIsTheLastScanline) {
  ExrLayout layout;
  layout.width = 1;
  layout.height = 3;
  layout.channels = {"Y"};
  layout.compression = ExrCompression::kNone;
  const std::vector<float> rows{1.0f, 2.0f, 3.0f};
  write_exr(path("r.exr"), layout, rows.data());
  // Uncompressed scanlines are 8 bytes of header and one float each, from the top down.
  const std::string bytes = read_file(path("r.exr"));
  float last = 0.0f;
  std::memcpy(&last, bytes.data() + bytes.size() - 4, 4);
  EXPECT_EQ(last, 1.0f);
}

TEST_F(Image, channelsKeepTheirOrderInMemory) {
  ExrLayout layout;
  layout.width = 2;
  layout.height = 1;
  layout.channels = {"R", "G", "B"};
  const std::vector<float> pixels{1, 2, 3, 4, 5, 6};
  write_exr(path("c.exr"), layout, pixels.data());
  const ExrImage image = read_exr(path("c.exr"));
  EXPECT_THAT(image.layout.channels, ElementsAre("B", "G", "R"));
  EXPECT_THAT(image.pixels, ElementsAre(3, 2, 1, 6, 5, 4));
}

TEST_F(Image, normalsAreHalvesEncodedAroundOneHalf) {
  const std::vector<float> normals{0.0f, 0.0f, 1.0f};
  write_normal_exr(path("n.exr"), 1, normals.data());
  const ExrImage image = read_exr(path("n.exr"));
  EXPECT_EQ(image.layout.type, ExrPixelType::kHalf);
  EXPECT_THAT(image.pixels, ElementsAre(1.0f, 0.5f, 0.5f));
}

TEST_F(Image, everyCompressionGivesTheSamePixelsAndTheSameBytesTwice) {
  std::mt19937 random(7);
  std::vector<float> height(64 * 64);
  for (float& h : height) h = static_cast<float>(random()) * 1e-10f;
  ExrLayout layout;
  layout.width = layout.height = 64;
  layout.channels = {"Y"};
  for (const ExrCompression compression :
       {ExrCompression::kNone, ExrCompression::kRle, ExrCompression::kZips, ExrCompression::kZip,
        ExrCompression::kPiz}) {
    layout.compression = compression;
    write_exr(path("1.exr"), layout, height.data());
    write_exr(path("2.exr"), layout, height.data());
    EXPECT_EQ(read_file(path("1.exr")), read_file(path("2.exr")));
    EXPECT_EQ(read_exr(path("1.exr")).pixels, height);
  }
}

TEST_F(Image, wrongLayoutsAreRefused) {
  const float pixel[2] = {0, 0};
  ExrLayout layout;
  layout.width = layout.height = 1;
  EXPECT_THROW(write_exr(path("x"), layout, pixel), std::invalid_argument);
  layout.channels = {"Y", "Y"};
  EXPECT_THROW(write_exr(path("x"), layout, pixel), std::invalid_argument);
  layout.channels = {"Y"};
  layout.attributes = {{"dataWindow", "mine"}};
  EXPECT_THROW(write_exr(path("x"), layout, pixel), std::invalid_argument);
  EXPECT_TRUE(files().empty());
}

TEST_F(Image, damagedAndForeignFilesAreRefusedByName) {
  atomic_write(path("text.exr"), "this is no image");
  EXPECT_THAT(failure([&] { read_exr(path("text.exr")); }), HasSubstr("text.exr"));
  EXPECT_THAT(failure([&] { read_exr(path("gone.exr")); }), HasSubstr("No such file"));
  std::vector<float> height(64 * 64, 1.0f);
  write_height_exr(path("h.exr"), 64, height.data());
  const std::string bytes = read_file(path("h.exr"));
  atomic_write(path("cut.exr"), bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT(failure([&] { read_exr(path("cut.exr")); }), HasSubstr("cut.exr"));
}

TEST_F(Image, pngHasItsSignatureSizeAndDepth) {
  const std::vector<uint16_t> samples{0, 65535, 1, 2, 3, 4};
  write_png16(path("a.png"), 2, 1, 3, samples.data());
  const std::string bytes = read_file(path("a.png"));
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x89PNG\r\n\x1a\n", 8));
  EXPECT_EQ(bytes.substr(16, 10), std::string("\0\0\0\x02\0\0\0\x01\x10\x02", 10));
  EXPECT_THROW(write_png16(path("b.png"), 0, 1, 3, samples.data()), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::image
