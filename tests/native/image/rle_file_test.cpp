#include "image/rle_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>
#include <half.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <random>
#include <string>

#include "image/atomic_file.h"
#include "image/exr.h"

namespace snowbough::image {
namespace {

/// The file that OpenEXR itself writes.
std::string by_openexr(const ExrLayout& layout, const std::vector<float>& pixels) {
  const std::string path =
      std::filesystem::temp_directory_path() / ("snowbough_rle_" + std::to_string(::getpid()));
  Imf::Header header(layout.width, layout.height);
  header.compression() = Imf::RLE_COMPRESSION;
  const bool halves = layout.type == ExrPixelType::kHalf;
  const Imf::PixelType type = halves ? Imf::HALF : Imf::FLOAT;
  for (const auto& [name, text] : layout.attributes) {
    header.insert(name.c_str(), Imf::StringAttribute(text));
  }
  const std::vector<half> rounded(pixels.begin(), pixels.end());
  const char* data = halves ? reinterpret_cast<const char*>(rounded.data())
                            : reinterpret_cast<const char*>(pixels.data());
  const size_t sample = halves ? sizeof(half) : sizeof(float);
  const size_t row = sample * layout.channels.size() * static_cast<size_t>(layout.width);
  Imf::FrameBuffer frame;
  for (size_t c = 0; c < layout.channels.size(); ++c) {
    header.channels().insert(layout.channels[c].c_str(), Imf::Channel(type));
    char* last_row = const_cast<char*>(data) + sample * c + row * (layout.height - 1);
    frame.insert(layout.channels[c].c_str(),
                 Imf::Slice(type, last_row, sample * layout.channels.size(), -row));
  }
  {
    Imf::OutputFile file(path.c_str(), header, 0);
    file.setFrameBuffer(frame);
    file.writePixels(layout.height);
  }
  std::string bytes = read_file(path);
  std::filesystem::remove(path);
  return bytes;
}

std::string by_us(const ExrLayout& layout, const std::vector<float>& pixels) {
  const std::string path =
      std::filesystem::temp_directory_path() / ("snowbough_rle_" + std::to_string(::getpid()));
  write_exr(path, layout, pixels.data());
  std::string bytes = read_file(path);
  std::filesystem::remove(path);
  return bytes;
}

ExrLayout layout_of(int32_t width, int32_t height, const std::vector<std::string>& channels) {
  ExrLayout layout;
  layout.width = width;
  layout.height = height;
  layout.channels = channels;
  return layout;
}

/// Bare stretches, even ones, smooth ones and noise, of all lengths.
std::vector<float> mixed_pixels(size_t count) {
  std::mt19937 random(7);
  std::vector<float> pixels;
  while (pixels.size() < count) {
    const size_t length = 1 + random() % 150;
    const float start = static_cast<float>(random() % 1000);
    const auto kind = random() % 4;
    for (size_t i = 0; i < length; ++i) {
      const float noise = static_cast<float>(random() % 65536) / 65536.0f;
      const float smooth = start + 0.25f * static_cast<float>(i);
      pixels.push_back(kind == 0 ? 0.0f : kind == 1 ? start : kind == 2 ? smooth : start * noise);
    }
  }
  pixels.resize(count);
  return pixels;
}

TEST(RleFile, holdsTheHeaderThePlacesAndTheLinesFromTheTop) {
  const std::string path =
      std::filesystem::temp_directory_path() / ("snowbough_rle_file_" + std::to_string(::getpid()));
  // One float does not compress, so that it is stored unpacked.
  const float pixels[] = {1.5f, -2.0f};
  write_rle_file(path, layout_of(1, 2, {"Y"}), "head", pixels);
  const std::string bytes = read_file(path);
  std::filesystem::remove(path);
  const auto at = [&]<typename T>(size_t place, T) {
    T value;
    std::memcpy(&value, bytes.data() + place, sizeof value);
    return value;
  };
  ASSERT_EQ(bytes.size(), 4u + 2 * 8 + 2 * (4 + 4 + 4));
  EXPECT_EQ(bytes.substr(0, 4), "head");
  EXPECT_EQ(at(4, uint64_t{}), 20u);
  EXPECT_EQ(at(12, uint64_t{}), 32u);
  EXPECT_EQ(at(20, int32_t{}), 0);
  EXPECT_EQ(at(24, int32_t{}), 4);
  EXPECT_EQ(at(28, float{}), -2.0f);
  EXPECT_EQ(at(32, int32_t{}), 1);
  EXPECT_EQ(at(40, float{}), 1.5f);
}

TEST(RleFile, holdsTheBytesThatOpenExrWrites) {
  for (const int32_t width : {1, 2, 3, 31, 64, 257, 1024}) {
    const ExrLayout layout = layout_of(width, 40, {"Y"});
    const std::vector<float> pixels = mixed_pixels(static_cast<size_t>(width) * 40);
    EXPECT_EQ(by_us(layout, pixels), by_openexr(layout, pixels)) << "width " << width;
  }
}

TEST(RleFile, holdsTheBytesThatOpenExrWritesForSeveralChannels) {
  for (const ExrPixelType type : {ExrPixelType::kFloat, ExrPixelType::kHalf}) {
    for (const auto& channels : {std::vector<std::string>{"R", "G", "B"}, {"u", "v"}}) {
      ExrLayout layout = layout_of(37, 11, channels);
      layout.type = type;
      const std::vector<float> pixels = mixed_pixels(37 * 11 * channels.size());
      EXPECT_EQ(by_us(layout, pixels), by_openexr(layout, pixels));
    }
  }
}

TEST(RleFile, holdsTheBytesThatOpenExrWritesWithLongNames) {
  ExrLayout layout = layout_of(16, 4, {"Y"});
  layout.attributes = {{"aVeryLongNameOfMoreThanThirtyOneLetters", "text"}};
  const std::vector<float> pixels = mixed_pixels(64);
  EXPECT_EQ(by_us(layout, pixels), by_openexr(layout, pixels));
}

}  // namespace
}  // namespace snowbough::image
