#include "snow/state/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "image/atomic_file.h"
#include "snow/state/check_sum.h"

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CheckpointFile : public ::testing::Test {
 protected:
  CheckpointFile()
      : path_(std::filesystem::temp_directory_path() /
              ("snowbough_state_" + std::to_string(::getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name())) {}
  ~CheckpointFile() override { std::filesystem::remove(path_); }

  std::string refusal() const {
    try {
      load_checkpoint(path_);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "accepted";
  }

  std::string path_;
};

Checkpoint example() {
  ObjectState ground;
  ground.name = "ground \xc3\xa4";
  ground.resolution = 3;
  ground.height = {0.1f, -0.0f, 1e-42f, std::nextafter(1.0f, 2.0f), 0.0f, -0.5f, 0.0f, 0.0f, 2.0f};
  for (size_t i = 0; i < ground.sums.size(); ++i) ground.sums[i] = static_cast<double>(i) / 3.0;
  ObjectState cart{"cart", 1, {0.0f}, {}, {}};
  const LandingState landing{
      99, {{50, "cart", 0, true, int64_t{1} << 40}, {51, "cart", 0, false, 3}}, 7, -8};
  return {"9f86d081", {48, {cart, ground}, landing, {}}};
}

/// The same without what has melted and drifted.
Checkpoint frozen_example() {
  Checkpoint frozen = example();
  auto& sums = frozen.state.objects[1].sums;
  std::fill(sums.begin() + 16, sums.end(), 0.0);
  return frozen;
}

TEST_F(CheckpointFile, comesBackBitForBit) {
  save_checkpoint(path_, example());
  const Checkpoint checkpoint = load_checkpoint(path_);
  EXPECT_EQ(checkpoint.description, "9f86d081");
  EXPECT_EQ(checkpoint.state.step_number, 48u);
  ASSERT_EQ(checkpoint.state.objects.size(), 2u);
  EXPECT_EQ(checkpoint.state.objects[0].name, "cart");
  EXPECT_THAT(checkpoint.state.objects[0].height, ElementsAre(0.0f));
  const ObjectState& ground = checkpoint.state.objects[1];
  const ObjectState expected = example().state.objects[1];
  EXPECT_EQ(ground.name, "ground \xc3\xa4");
  EXPECT_EQ(ground.resolution, 3);
  ASSERT_EQ(ground.height.size(), 9u);
  EXPECT_EQ(0, std::memcmp(ground.height.data(), expected.height.data(), 36));
  EXPECT_EQ(ground.sums, expected.sums);
  const LandingState& landing = checkpoint.state.landing;
  EXPECT_EQ(landing.on_floors, 7);
  EXPECT_EQ(landing.left, -8);
  ASSERT_EQ(landing.air.size(), 2u);
  EXPECT_EQ(landing.air[0].time, 50);
  EXPECT_EQ(landing.clock, 99);
  EXPECT_EQ(landing.air[0].receiver, "cart");
  EXPECT_TRUE(landing.air[0].is_back);
  EXPECT_EQ(landing.air[0].units, int64_t{1} << 40);
}

TEST_F(CheckpointFile, keepsPlanesAndPressers) {
  Checkpoint checkpoint = frozen_example();
  checkpoint.state.objects[1].planes["mask"] = {0.0f, 0.25f, -0.0f, 0.0f, 1.0f,
                                                0.5f, 0.0f,  3.0f,  0.0f};
  checkpoint.state.pressers["foot"] = {{1.0f, -2.0f, 0.0f}, {0.5f, 0.25f, 1e-42f}};
  save_checkpoint(path_, checkpoint);
  const Checkpoint read = load_checkpoint(path_);
  EXPECT_TRUE(read.state.objects[0].planes.empty());
  EXPECT_EQ(read.state.objects[1].planes, checkpoint.state.objects[1].planes);
  EXPECT_EQ(read.state.pressers, checkpoint.state.pressers);
  EXPECT_EQ(image::read_file(path_)[16], 5);
}

TEST_F(CheckpointFile, withoutPlanesHasTheOlderFormat) {
  save_checkpoint(path_, frozen_example());
  EXPECT_EQ(image::read_file(path_)[16], 4);
  Checkpoint thawed = frozen_example();
  thawed.state.objects[1].sums[16] = 0.5;
  save_checkpoint(path_, thawed);
  EXPECT_EQ(image::read_file(path_)[16], 6);
  EXPECT_EQ(load_checkpoint(path_).state.objects[1].sums, thawed.state.objects[1].sums);
  save_checkpoint(path_, example());
  EXPECT_EQ(image::read_file(path_)[16], 7);
}

TEST_F(CheckpointFile, withPlanesIsRefusedIfCutOffOrChangedAnywhere) {
  Checkpoint checkpoint = example();
  checkpoint.state.objects[0].planes["packed"] = {0.5f};
  checkpoint.state.pressers["foot"] = {{1.0f, -2.0f, 0.0f}};
  save_checkpoint(path_, checkpoint);
  const std::string whole = image::read_file(path_);
  for (size_t length = 1; length < whole.size(); length += 7) {
    image::atomic_write(path_, whole.substr(0, length));
    EXPECT_THAT(refusal(), HasSubstr("truncated")) << length;
  }
  checkpoint.state.objects[0].planes["packed"] = {0.5f, 0.5f};
  EXPECT_THROW(save_checkpoint(path_, checkpoint), std::invalid_argument);
}

TEST_F(CheckpointFile, theSameDataGivesTheSameBytes) {
  save_checkpoint(path_, example());
  const std::string first = image::read_file(path_);
  save_checkpoint(path_, example());
  EXPECT_EQ(image::read_file(path_), first);
}

TEST_F(CheckpointFile, isRefusedWhereverItIsCutOff) {
  save_checkpoint(path_, example());
  const std::string whole = image::read_file(path_);
  for (size_t length = 1; length < whole.size(); length += 7) {
    image::atomic_write(path_, whole.substr(0, length));
    EXPECT_THAT(refusal(), HasSubstr("truncated")) << length;
  }
}

TEST_F(CheckpointFile, isRefusedWhereverAByteIsWrong) {
  save_checkpoint(path_, example());
  const std::string whole = image::read_file(path_);
  for (size_t at = 0; at < whole.size(); at += 5) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    image::atomic_write(path_, damaged);
    EXPECT_NE(refusal(), "accepted") << at;
  }
}

TEST_F(CheckpointFile, namesFileAndReason) {
  EXPECT_THAT(refusal(), HasSubstr("No such file"));
  image::atomic_write(path_, "a pickle");
  EXPECT_THAT(refusal(), HasSubstr("not a Snowbough checkpoint"));
  EXPECT_THAT(refusal(), HasSubstr(path_));
  image::atomic_write(path_, "");
  EXPECT_THAT(refusal(), HasSubstr("not a Snowbough checkpoint"));
}

TEST_F(CheckpointFile, ofAnotherVersionIsRefusedWithTheVersion) {
  save_checkpoint(path_, example());
  std::string bytes = image::read_file(path_);
  bytes[16] = 2;
  image::atomic_write(path_, bytes);
  EXPECT_THAT(refusal(), HasSubstr("version 2"));
}

/// A file with another body, but the right length and check sum.
std::string with_body(std::string file, const std::string& body) {
  const auto sum = static_cast<uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size())));
  const uint64_t size = body.size();
  std::memcpy(&file[20], &size, sizeof size);
  std::memcpy(&file[28], &sum, sizeof sum);
  return file.substr(0, 32) + body;
}

TEST_F(CheckpointFile, withImpossibleContentIsRefusedDespiteItsCheckSum) {
  save_checkpoint(path_, example());
  const std::string whole = image::read_file(path_);
  const std::string body = whole.substr(32);
  image::atomic_write(path_, with_body(whole, body));
  EXPECT_EQ(refusal(), "accepted");
  image::atomic_write(path_, with_body(whole, body + "x"));
  EXPECT_THAT(refusal(), HasSubstr("bytes after its end"));
  std::string large = body;
  const uint32_t resolution = 8193;
  std::memcpy(&large[28], &resolution, sizeof resolution);  // of "cart"
  image::atomic_write(path_, with_body(whole, large));
  EXPECT_THAT(refusal(), HasSubstr("impossible size"));
}

TEST_F(CheckpointFile, isCheckedByTheCallerBeforeItsMapsAreUnpacked) {
  save_checkpoint(path_, example());
  std::vector<std::string> names;
  const auto check = [&](const CheckpointOutline& outline) {
    for (const auto& [name, resolution] : outline.maps) names.push_back(name);
    throw std::invalid_argument("another simulation");
  };
  EXPECT_THROW(load_checkpoint(path_, check), std::invalid_argument);
  EXPECT_THAT(names, ElementsAre("cart", "ground \xc3\xa4"));
}

TEST_F(CheckpointFile, withAMapOfTheWrongSizeIsNotWritten) {
  Checkpoint data = example();
  data.state.objects[0].height.pop_back();
  EXPECT_THROW(save_checkpoint(path_, data), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(path_));
}

// The check value of CRC-32 in the catalogue of parametrised CRC algorithms.
TEST(CheckSum, isCrc32InOnePieceOrTwo) {
  EXPECT_EQ(check_sum("123456789"), 0xCBF43926u);
  EXPECT_EQ(check_sum("56789", check_sum("1234")), 0xCBF43926u);
}

}  // namespace
}  // namespace snowbough::snow
