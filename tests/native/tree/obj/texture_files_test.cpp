#include "tree/obj/texture_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace snowbough::tree {
namespace {

namespace fs = std::filesystem;

class TextureFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(testing::TempDir()) /
        (std::string("textures_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void make(const std::string& name) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << "";
  }
  /// `path` below the test's folder; empty for an empty one.
  std::string below(const std::string& path) const {
    return path.empty() ? path : fs::relative(path, folder_).string();
  }

  fs::path folder_;
};

TEST_F(TextureFiles, AFileIsFoundWhateverItsCaseAndAFolderIsNone) {
  make("Maps/Bark.PNG");
  EXPECT_EQ(below(find_below(folder_, "maps/bark.png").string()), "Maps/Bark.PNG");
  EXPECT_TRUE(find_below(folder_, "maps").empty());
  EXPECT_TRUE(find_below(folder_, "maps/leaf.png").empty());
}

TEST_F(TextureFiles, TheOneBesideTheFileGoesBeforeThatInAFolder) {
  make("textures/bark.png");
  EXPECT_EQ(below(find_texture({folder_}, "bark.png")), "textures/bark.png");
  make("bark.png");
  EXPECT_EQ(below(find_texture({folder_}, "bark.png")), "bark.png");
  EXPECT_EQ(find_texture({folder_}, "leaf.png"), "");
}

TEST_F(TextureFiles, AConvertedImageIsTakenWhereItIsTheOnlyOne) {
  make("textures/Bark.png");
  make("textures/bark.txt");
  EXPECT_EQ(below(find_converted_texture({folder_}, "bark.tga")), "textures/Bark.png");
  make("bark.jpg");
  EXPECT_EQ(find_converted_texture({folder_}, "bark.tga"), "");
}

}  // namespace
}  // namespace snowbough::tree
