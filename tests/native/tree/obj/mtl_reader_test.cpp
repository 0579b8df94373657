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
  std::map<std::string, ObjMaterial> read(const std::vector<std::string>& libraries,
                                          const std::string& obj = "tree.obj",
                                          bool outside_files = false) {
    return read_materials((folder_ / obj).string(), libraries, {"a", "b", "leaf", "bark"},
                          outside_files, warnings_);
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
  EXPECT_THAT(read({"a.mtl"})["leaf"].diffuse_texture.path, HasSubstr("leaf green.png"));
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(Materials, AConvertedTextureIsTakenAndSaidOnce) {
  write("a.mtl",
        "newmtl leaf\nmap_Kd leaf.tga\nmap_d leaf.tga\nnewmtl bark\nmap_Kd old/Leaf.TGA\n");
  write("Textures/Leaf.png", "");
  write("Textures/leaf.txt", "");
  auto materials = read({"a.mtl"});
  EXPECT_THAT(materials["leaf"].diffuse_texture.path, HasSubstr("Textures/Leaf.png"));
  EXPECT_THAT(materials["leaf"].alpha_texture.path, HasSubstr("Textures/Leaf.png"));
  EXPECT_THAT(materials["bark"].diffuse_texture.path, HasSubstr("Textures/Leaf.png"));
  EXPECT_THAT(warnings_, ElementsAre("texture 'leaf.tga' of material 'leaf' is missing: "
                                     "'Leaf.png' is used instead"));
}

TEST_F(Materials, OfSeveralConvertedTexturesNoneIsTaken) {
  write("a.mtl", "newmtl leaf\nmap_Kd leaf.tga\n");
  write("leaf.png", "");
  write("textures/leaf.jpg", "");
  EXPECT_EQ(read({"a.mtl"})["leaf"].diffuse_texture.path, "");
  EXPECT_THAT(warnings_, ElementsAre("texture 'leaf.tga' of material 'leaf' is missing"));
}

TEST_F(Materials, AllTexturesOfAPackAreFoundWithHowTheyLie) {
  write("a.mtl",
        "newmtl bark\nTf 0.5 0.75 0.25\nmap_Kd -s 2 4 1 -o 0.5 0.25 maps\\Bark.JPG\n"
        "map_Ks bark_spec.jpg\nmap_bump -bm 0.3 bark_bump.jpg\nnorm bark_n.png\n");
  write("Maps/bark.jpg", "");
  write("TEXTURES/Bark_Spec.jpg", "");
  write("bark_bump.jpg", "");
  write("../Textures/Bark_N.png", "");
  const ObjMaterial bark = read({"a.mtl"})["bark"];
  std::filesystem::remove_all(folder_.parent_path() / "Textures");
  EXPECT_TRUE(bark.defined);
  EXPECT_EQ(bark.transmission, glm::vec3(0.5f, 0.75f, 0.25f));
  EXPECT_THAT(bark.diffuse_texture.path, HasSubstr("/Maps/bark.jpg"));
  EXPECT_EQ(bark.diffuse_texture.scale, glm::vec2(2.0f, 4.0f));
  EXPECT_EQ(bark.diffuse_texture.offset, glm::vec2(0.5f, 0.25f));
  EXPECT_THAT(bark.specular_texture.path, HasSubstr("/TEXTURES/Bark_Spec.jpg"));
  EXPECT_THAT(bark.bump_texture.path, HasSubstr("bark_bump.jpg"));
  EXPECT_FLOAT_EQ(bark.bump_strength, 0.3f);
  EXPECT_THAT(bark.normal_texture.path, HasSubstr("/Textures/Bark_N.png"));
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(Materials, ABumpMapThatIsCalledANormalMapIsOne) {
  write("a.mtl", "newmtl a\nmap_bump x_Normal.png\nnewmtl b\nbump northern_oak.png\n");
  write("x_normal.png", "");
  write("northern_oak.png", "");
  auto materials = read({"a.mtl"});
  EXPECT_EQ(materials["a"].bump_texture.path, "");
  EXPECT_THAT(materials["a"].normal_texture.path, HasSubstr("x_normal.png"));
  EXPECT_THAT(materials["b"].bump_texture.path, HasSubstr("northern_oak.png"));
}

TEST_F(Materials, ABumpMapWhoseNameEndsInAMereNIsANormalMap) {
  write("a.mtl", "newmtl a\nbump bark_n.png\nnewmtl b\nbump n_bark.png\n");
  write("bark_n.png", "");
  write("n_bark.png", "");
  auto materials = read({"a.mtl"});
  EXPECT_THAT(materials["a"].normal_texture.path, HasSubstr("bark_n.png"));
  EXPECT_THAT(materials["b"].bump_texture.path, HasSubstr("n_bark.png"));
}

TEST_F(Materials, ATextureIsFoundInAFolderWithinTheTextures) {
  write("a.mtl", "newmtl leaf\nmap_Kd leaf.png\nmap_d mask.png\n");
  write("Textures/Leaves/Leaf.png", "");
  write("Other/Leaves/mask.png", "");
  EXPECT_THAT(read({"a.mtl"})["leaf"].diffuse_texture.path, HasSubstr("Textures/Leaves/Leaf.png"));
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("mask.png")));
}

TEST_F(Materials, NamesMayStandInQuotes) {
  write("a.mtl", "newmtl leaf\nmap_Kd -bm 1 \"C:\\art\\leaf green.png\"\n");
  write("leaf green.png", "");
  EXPECT_THAT(read({"a.mtl"})["leaf"].diffuse_texture.path, HasSubstr("leaf green.png"));
}

TEST_F(Materials, NamesInLatin1AreThoseOfTheFilesInUtf8) {
  // The accented E stands as one byte in the library, as two in the name of the file.
  write("a.mtl",
        "newmtl leaf\nmap_Kd \xc9"
        "corce.png\nmap_d \xe9garee.png\n");
  write(
      "\xc3\xa9"
      "corce.png",
      "");
  EXPECT_THAT(read({"a.mtl"})["leaf"].diffuse_texture.path, HasSubstr("\xc3\xa9"
                                                                      "corce.png"));
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("\xc3\xa9garee.png")));
}

TEST_F(Materials, OfWhatNothingIsMadeNothingIsMissed) {
  write("a.mtl", "newmtl flower\nKd x\nmap_Kd gone.png\nnewmtl leaf\nd 0.5\n");
  EXPECT_FLOAT_EQ(read({"a.mtl"})["leaf"].opacity, 0.5f);
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(Materials, TexturesBesideTheObjAreFoundFromALibraryElsewhere) {
  write("lib/a.mtl", "newmtl leaf\nmap_Kd leaf.png\n");
  write("leaf.png", "");
  EXPECT_THAT(read({"lib/a.mtl"})["leaf"].diffuse_texture.path, HasSubstr("leaf.png"));
}

TEST_F(Materials, ATextureThatManyNameIsMissingOnce) {
  write("a.mtl", "newmtl a\nmap_Kd maps\\Gone.png\nmap_d gone.png\nnewmtl b\nmap_Kd gone.png\n");
  read({"a.mtl"});
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("Gone.png")));
}

TEST_F(Materials, TheLibraryOfTheObjsOwnNameIsTakenWhereNoneIsNamedOrThere) {
  write("tree.mtl", "newmtl leaf\nd 0.5\n");
  EXPECT_FLOAT_EQ(read({})["leaf"].opacity, 0.5f);
  EXPECT_FLOAT_EQ(read({"renamed.mtl"})["leaf"].opacity, 0.5f);
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(Materials, WhatIsMissingIsNamed) {
  write("a.mtl", "newmtl leaf\nmap_Kd gone.png\n");
  EXPECT_EQ(read({"a.mtl", "other.mtl"})["leaf"].diffuse_texture.path, "");
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

TEST_F(Materials, ALibraryMayEndItsLinesByCarriageReturnsAlone) {
  write("a.mtl", "newmtl leaf\rd 0.5\rnewmtl bark\rd 0.25\r");
  auto materials = read({"a.mtl"});
  EXPECT_FLOAT_EQ(materials["leaf"].opacity, 0.5f);
  EXPECT_FLOAT_EQ(materials["bark"].opacity, 0.25f);
}

TEST_F(Materials, TexturesElsewhereAreReadOnlyWhereThatIsAllowed) {
  write("secret.png", "");
  const std::string absolute = (folder_ / "secret.png").string();
  write("packs/oak/a.mtl", "newmtl leaf\nmap_Kd ../../secret.png\nnewmtl bark\nmap_Kd " + absolute);
  const std::string obj = "packs/oak/tree.obj";
  auto materials = read({"a.mtl"}, obj);
  EXPECT_EQ(materials["leaf"].diffuse_texture.path, "");
  EXPECT_EQ(materials["bark"].diffuse_texture.path, "");
  EXPECT_THAT(warnings_,
              ElementsAre(HasSubstr("files elsewhere are only read with outside_files")));
  warnings_.clear();
  materials = read({"a.mtl"}, obj, true);
  EXPECT_EQ(materials["leaf"].diffuse_texture.path, absolute);
  EXPECT_EQ(materials["bark"].diffuse_texture.path, absolute);
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(Materials, ALinkLeadsNowhereElseEither) {
  write("secret/a.mtl", "newmtl leaf\nd 0.5\n");
  write("secret/leaf.png", "");
  write("packs/oak/b.mtl", "newmtl leaf\nmap_Kd leaf.png\n");
  std::filesystem::create_symlink(folder_ / "secret", folder_ / "packs/oak/textures");
  std::filesystem::create_symlink(folder_ / "secret/a.mtl", folder_ / "packs/oak/a.mtl");
  const std::string obj = "packs/oak/tree.obj";
  EXPECT_EQ(read({"b.mtl"}, obj)["leaf"].diffuse_texture.path, "");
  EXPECT_TRUE(read({"a.mtl"}, obj).empty());
  EXPECT_TRUE(read({"../../secret/a.mtl"}, obj).empty());
  EXPECT_THAT(read({"b.mtl"}, obj, true)["leaf"].diffuse_texture.path, HasSubstr("leaf.png"));
  EXPECT_FLOAT_EQ(read({"../../secret/a.mtl"}, obj, true)["leaf"].opacity, 0.5f);
}

TEST_F(Materials, ATextureInTheFolderAboveIsFoundByItsWay) {
  write("pack/obj/a.mtl", "newmtl leaf\nmap_Kd ../art/leaf.png\n");
  write("pack/art/leaf.png", "");
  EXPECT_THAT(read({"a.mtl"}, "pack/obj/tree.obj")["leaf"].diffuse_texture.path,
              HasSubstr("art/leaf.png"));
  EXPECT_THAT(warnings_, IsEmpty());
}

}  // namespace
}  // namespace snowbough::tree
