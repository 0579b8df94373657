#include "snow/state/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "image/atomic_file.h"

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

class Checkpoint : public ::testing::Test {
 protected:
  Checkpoint()
      : path_(std::filesystem::temp_directory_path() /
              ("snowbough_state_" + std::to_string(::getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name())) {}
  ~Checkpoint() override { std::filesystem::remove(path_); }

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

CheckpointData example() {
  CheckpointData data;
  data.description = "9f86d081";
  data.step_number = 48;
  data.totals = {{"deposited_volume", 1.0 / 3.0}, {"slid_volume", 1e-300}};
  CheckpointMap map;
  map.name = "ground \xc3\xa4";
  map.resolution = 2;
  map.height = {0.1f, -0.0f, 1e-42f, std::nextafter(1.0f, 2.0f)};
  map.totals = {{"slid", 0.1}};
  data.maps = {map, map};
  data.maps[1].name = "cart";
  data.maps[1].height[0] = 7.0f;
  return data;
}

TEST_F(Checkpoint, comesBackBitForBit) {
  save_checkpoint(path_, example());
  const CheckpointData data = load_checkpoint(path_);
  EXPECT_EQ(data.description, "9f86d081");
  EXPECT_EQ(data.step_number, 48u);
  EXPECT_THAT(data.totals,
              ElementsAre(Pair("deposited_volume", 1.0 / 3.0), Pair("slid_volume", 1e-300)));
  ASSERT_EQ(data.maps.size(), 2u);
  EXPECT_EQ(data.maps[0].name, "ground \xc3\xa4");
  EXPECT_EQ(data.maps[0].resolution, 2);
  EXPECT_EQ(0, std::memcmp(data.maps[0].height.data(), example().maps[0].height.data(), 16));
  EXPECT_THAT(data.maps[0].totals, ElementsAre(Pair("slid", 0.1)));
  EXPECT_EQ(data.maps[1].height[0], 7.0f);
}

TEST_F(Checkpoint, theSameDataGivesTheSameBytes) {
  save_checkpoint(path_, example());
  const std::string first = image::read_file(path_);
  save_checkpoint(path_, example());
  EXPECT_EQ(image::read_file(path_), first);
}

TEST_F(Checkpoint, isRefusedWhereverItIsCutOff) {
  save_checkpoint(path_, example());
  const std::string whole = image::read_file(path_);
  for (size_t length = 1; length < whole.size(); length += 7) {
    image::atomic_write(path_, whole.substr(0, length));
    EXPECT_THAT(refusal(), HasSubstr("truncated")) << length;
  }
}

TEST_F(Checkpoint, isRefusedWhereverAByteIsWrong) {
  save_checkpoint(path_, example());
  const std::string whole = image::read_file(path_);
  for (size_t at = 0; at < whole.size(); at += 5) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    image::atomic_write(path_, damaged);
    EXPECT_NE(refusal(), "accepted") << at;
  }
}

TEST_F(Checkpoint, namesFileAndReason) {
  EXPECT_THAT(refusal(), HasSubstr("No such file"));
  image::atomic_write(path_, "a pickle");
  EXPECT_THAT(refusal(), HasSubstr("not a Snowbough checkpoint"));
  EXPECT_THAT(refusal(), HasSubstr(path_));
  image::atomic_write(path_, "");
  EXPECT_THAT(refusal(), HasSubstr("not a Snowbough checkpoint"));
}

TEST_F(Checkpoint, ofAnotherVersionIsRefusedWithTheVersion) {
  save_checkpoint(path_, example());
  std::string bytes = image::read_file(path_);
  bytes[16] = 2;
  image::atomic_write(path_, bytes);
  EXPECT_THAT(refusal(), HasSubstr("version 2"));
}

TEST_F(Checkpoint, withAMapOfTheWrongSizeIsNotWritten) {
  CheckpointData data = example();
  data.maps[0].height.pop_back();
  EXPECT_THROW(save_checkpoint(path_, data), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(path_));
}

}  // namespace
}  // namespace snowbough::snow
