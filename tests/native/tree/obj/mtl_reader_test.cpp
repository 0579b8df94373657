#include "tree/obj/mtl_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace snowbough::tree {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Materials : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(testing::TempDir()) /
        (std::string("materials_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::map<std::string, FoliageMaterial> read(const std::vector<std::string>& libraries) {
    return read_materials((folder_ / "tree.obj").string(), libraries, warnings_);
  }

  std::filesystem::path folder_;
  std::vector<std::string> warnings_;
};

TEST_F(Materials, ColourAndOpacityAreReadAndTransparencyIsItsComplement) {
  write("a.mtl", "newmtl leaf\nKd 0.25 0.5 0.75\nd 0.5\nnewmtl bark\nTr 0.25\n");
  auto materials = read({"a.mtl"});
  EXPECT_EQ(materials["leaf"].diffuse, glm::vec3(0.25f, 0.5f, 0.75f));
  EXPECT_FLOAT_EQ(materials["leaf"].opacity, 0.5f);
  EXPECT_FLOAT_EQ(materials["bark"].opacity, 0.75f);
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(Materials, ATextureIsFoundInAFolderBesideTheLibraryWhateverItsCase) {
  write("a.mtl", "newmtl leaf\nmap_Kd -s 1 1 1 C:\\art\\Leaf Green.PNG\n");
  write("textures/leaf green.png", "");
  EXPECT_THAT(read({"a.mtl"})["leaf"].diffuse_texture, HasSubstr("leaf green.png"));
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(Materials, WhatIsMissingIsNamed) {
  write("a.mtl", "newmtl leaf\nmap_Kd gone.png\n");
  EXPECT_EQ(read({"a.mtl", "other.mtl"})["leaf"].diffuse_texture, "");
  EXPECT_THAT(warnings_,
              testing::UnorderedElementsAre(HasSubstr("gone.png"), HasSubstr("other.mtl")));
}

TEST_F(Materials, OfANameThatComesTwiceTheFirstCounts) {
  write("a.mtl", "newmtl leaf\nd 0.5\n");
  write("b.mtl", "newmtl leaf\nd 0.25\n");
  EXPECT_FLOAT_EQ(read({"a.mtl", "b.mtl"})["leaf"].opacity, 0.5f);
}

TEST_F(Materials, AMalformedLineIsAWarningWithItsPlace) {
  write("a.mtl", "newmtl leaf\nKd x\nd 0.5\n");
  EXPECT_FLOAT_EQ(read({"a.mtl"})["leaf"].opacity, 0.5f);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("a.mtl:2")));
}

}  // namespace
}  // namespace snowbough::tree
