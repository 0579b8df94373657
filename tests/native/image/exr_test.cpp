#include "image/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "image/atomic_file.h"
#include "native/image/temporary_folder.h"

namespace snowbough::image {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Exr = TemporaryFolder;

ExrLayout height_layout(int32_t resolution) {
  ExrLayout layout;
  layout.width = layout.height = resolution;
  layout.channels = {"Y"};
  return layout;
}

TEST_F(Exr, rowZeroIsTheLastScanline) {
  ExrLayout layout;
  layout.width = 1;
  layout.height = 3;
  layout.channels = {"Y"};
  const std::vector<float> rows{1.0f, 2.0f, 3.0f};
  write_exr(path("r.exr"), layout, rows.data());
  // Scanlines are 8 bytes of header and one float each, which RLE cannot pack, from the top down.
  const std::string bytes = read_file(path("r.exr"));
  float last = 0.0f;
  std::memcpy(&last, bytes.data() + bytes.size() - 4, 4);
  EXPECT_EQ(last, 1.0f);
}

TEST_F(Exr, halvesComeBackRounded) {
  ExrLayout layout;
  layout.width = layout.height = 1;
  layout.channels = {"R", "G", "B"};
  layout.type = ExrPixelType::kHalf;
  const std::vector<float> pixel{0.5f, 1.0f / 3.0f, 1.0f};
  write_exr(path("n.exr"), layout, pixel.data());
  const ExrImage image = read_exr(path("n.exr"));
  EXPECT_EQ(image.layout.type, ExrPixelType::kHalf);
  EXPECT_THAT(image.pixels, ElementsAre(1.0f, 0.333251953125f, 0.5f));
}

TEST_F(Exr, noiseComesBackAndGivesTheSameBytesTwice) {
  std::mt19937 random(7);
  std::vector<float> height(64 * 64);
  for (float& h : height) h = static_cast<float>(random()) * 1e-10f;
  write_exr(path("1.exr"), height_layout(64), height.data());
  write_exr(path("2.exr"), height_layout(64), height.data());
  EXPECT_EQ(read_file(path("1.exr")), read_file(path("2.exr")));
  EXPECT_EQ(read_exr(path("1.exr")).pixels, height);
}

/// Bare maps are packed most: their files are the smallest for their size.
TEST_F(Exr, aLargeBareMapIsReadInEveryCompression) {
  std::vector<float> bare(size_t{4096} * 2048, 0.0f);
  for (int method = Imf::NO_COMPRESSION; method <= Imf::PIZ_COMPRESSION; ++method) {
    Imf::Header header(4096, 2048);
    header.compression() = static_cast<Imf::Compression>(method);
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    Imf::FrameBuffer frame;
    frame.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(bare.data()), sizeof(float),
                                 4096 * sizeof(float)));
    {
      Imf::OutputFile file(path("bare.exr").c_str(), header, 0);
      file.setFrameBuffer(frame);
      file.writePixels(2048);
    }
    EXPECT_EQ(read_exr(path("bare.exr")).pixels, bare) << "compression " << method;
  }
}

TEST_F(Exr, wrongLayoutsAreRefused) {
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

TEST_F(Exr, damagedAndForeignFilesAreRefusedByName) {
  atomic_write(path("text.exr"), "this is no image");
  EXPECT_THAT(failure([&] { read_exr(path("text.exr")); }), HasSubstr("text.exr"));
  EXPECT_THAT(failure([&] { read_exr(path("gone.exr")); }), HasSubstr("No such file"));
  std::vector<float> height(64 * 64, 1.0f);
  write_exr(path("h.exr"), height_layout(64), height.data());
  const std::string bytes = read_file(path("h.exr"));
  atomic_write(path("cut.exr"), bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT(failure([&] { read_exr(path("cut.exr")); }), HasSubstr("cut.exr"));
}

/// Offset of an attribute's value in a file of write_exr.
size_t value_of(const std::string& bytes, const std::string& name_and_type) {
  return bytes.find(name_and_type) + name_and_type.size() + 4;
}

/// RLE cannot pack it.
const std::vector<float> kUneven{0.1f, 0.7f, 0.3f, 1.9f, 0.2f, 2.6f};

/// An image of 3 x 2 pixels.
std::string small_file(const std::string& path) {
  ExrLayout layout = height_layout(3);
  layout.height = 2;
  write_exr(path, layout, kUneven.data());
  return read_file(path);
}

TEST_F(Exr, anAttributeLongerThanItsContentIsRefused) {
  // OpenEXR ends the channel list at its empty name, and reads the rest as attributes.
  std::string bytes = small_file(path("a.exr"));
  const size_t at = value_of(bytes, std::string("channels\0chlist\0", 16));
  bytes.insert(at + 19, std::string("x\0y\0\xff\xff\xff\x7f", 8));
  bytes[at - 4] = 27;
  atomic_write(path("a.exr"), bytes);
  EXPECT_THAT(failure([&] { read_exr(path("a.exr")); }), HasSubstr("wrong size"));
}

TEST_F(Exr, attributesThatAnImageDoesNotNeedAreSkipped) {
  // A preview image of 4 G pixels, which OpenEXR would allocate.
  std::string bytes = small_file(path("p.exr"));
  bytes.insert(8, std::string("p\0preview\0\x08\0\0\0\xff\xff\0\0\xff\xff\0\0", 22));
  // The table of line offsets counts from the beginning of the file.
  const size_t table = bytes.size() - 2 * (8 + 12) - 16;
  for (const size_t line : {0, 1}) {
    bytes[table + 8 * line] = static_cast<char>(bytes[table + 8 * line] + 22);
  }
  atomic_write(path("p.exr"), bytes);
  EXPECT_EQ(read_exr(path("p.exr")).pixels, kUneven);
}

TEST_F(Exr, aLineOffsetNearTheLargestNumberIsRefused) {
  std::string bytes = small_file(path("o.exr"));
  const size_t table = bytes.size() - 2 * (8 + 12) - 16;
  bytes.replace(table, 8, std::string("\xfc\xff\xff\xff\xff\xff\xff\xff", 8));
  atomic_write(path("o.exr"), bytes);
  EXPECT_THAT(failure([&] { read_exr(path("o.exr")); }), HasSubstr("o.exr"));
}

}  // namespace
}  // namespace snowbough::image
