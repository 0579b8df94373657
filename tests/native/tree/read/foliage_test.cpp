#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "native/tree/tree_text.h"
#include "tree/read_tree.h"

namespace snowbough::tree {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

TEST_F(ReadTree, LeavesHangOnTheirTwigAndStayThereWhenItIsSimplified) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g leaves");
  // On limb 1 (along x at z = 2.5 ...) and on twig 3.
  text.leaf({1.5f, 0.15f, 2.8f}, {0.0f, 0.2f, 0});
  text.leaf({-1.25f, 0.1f, 5.2f}, {0.0f, 0.2f, 0});
  for (const Simplify simplify : {Simplify::kNone, Simplify::kThesis}) {
    const Skeleton skeleton = read(text.text(), {.simplify = simplify});
    ASSERT_EQ(skeleton.foliage.leaf_branch.size(), 2u);
    EXPECT_EQ(skeleton.branches[skeleton.foliage.leaf_branch[0]].name, "branch1");
    EXPECT_EQ(skeleton.branches[skeleton.foliage.leaf_branch[1]].name, "limb3");
    EXPECT_LT(glm::distance(skeleton.foliage.leaf_attach_point[0], glm::vec3(1.5f, 0, 2.8f)),
              0.01f);
  }
}

TEST_F(ReadTree, LeavesOnPetiolesHangOnTheTwigTheyPointAt) {
  // Two parallel twigs 0.5 apart; the leaves stand 0.4 away from the right one and only 0.1 from
  // the left one, but point at the right one. No petiole is drawn.
  TreeText text;
  text.line("g trunk");
  text.limb({0, 0, 0}, {1, 0, 0}, 9, 0.2f, false);
  text.line("g twigs");
  text.limb({1, 0, 0}, {0, 0, 1}, 8, 0.02f, false);
  text.limb({1.5f, 0, 0}, {0, 0, 1}, 8, 0.02f, false);
  text.limb({7, 0, 0}, {0, 0, 1}, 8, 0.02f, false);
  text.line("g leaves");
  for (int i = 0; i < 30; ++i) text.leaf({7.4f, 0, 0.2f + 0.2f * i}, {0.2f, 0, 0});
  text.leaf({1.1f, 0, 3}, {-0.2f, 0, 0});
  const Skeleton skeleton = read(text.text(), {.up_axis = UpAxis::kZ});
  ASSERT_EQ(skeleton.foliage.leaf_branch.size(), 31u);
  EXPECT_EQ(skeleton.branches[skeleton.foliage.leaf_branch[30]].name, "twigs_2");
}

TEST_F(ReadTree, FoliageKeepsGeometryUvsAndMaterials) {
  TreeText text;
  text.line("mtllib my leaves.mtl");
  text.tree(false, numbered);
  text.line("g leaves\nusemtl Leaf A");
  text.leaf({0.5f, 0.1f, 2.6f}, {0.1f, 0.2f, 0});
  text.line("usemtl Leaf B");
  text.leaf({0.5f, 0.1f, 2.7f}, {0.1f, 0.2f, 0});
  std::filesystem::create_directories(folder_ / "textures");
  write("my leaves.mtl",
        "newmtl Leaf A\nKd 0.1 0.5 0.2\nd 0.75\nmap_Kd -s 1 1 1 C:\\art\\Leaf Green.PNG\nmap_d "
        "alpha.png\n"
        "newmtl Leaf B\nKd x\nmap_Kd missing one.png\n");
  write("textures/leaf green.png", "");
  write("alpha.png", "");
  const Skeleton skeleton = read(text.text());
  const Foliage& foliage = skeleton.foliage;
  EXPECT_THAT(foliage.face_begin, ElementsAre(0, 4, 8));
  EXPECT_EQ(foliage.vertices[0], glm::vec3(0.5f, 0.1f, 2.6f));
  EXPECT_EQ(foliage.corner_uv[0], glm::vec2(0.5f, 0.1f));
  EXPECT_THAT(foliage.face_material, ElementsAre(0, 1));
  EXPECT_THAT(foliage.face_leaf, ElementsAre(0, 1));
  ASSERT_EQ(foliage.materials.size(), 2u);
  EXPECT_EQ(foliage.materials[0].diffuse, glm::vec3(0.1f, 0.5f, 0.2f));
  EXPECT_FLOAT_EQ(foliage.materials[0].opacity, 0.75f);
  EXPECT_THAT(foliage.materials[0].diffuse_texture.path,
              testing::EndsWith("textures/leaf green.png"));
  EXPECT_THAT(foliage.materials[0].alpha_texture.path, testing::EndsWith("/alpha.png"));
  EXPECT_THAT(
      skeleton.report.warnings,
      testing::UnorderedElementsAre(HasSubstr("my leaves.mtl:7: malformed Kd"),
                                    HasSubstr("texture 'missing one.png' of material 'Leaf B'")));
}

TEST_F(ReadTree, AMissingLibraryIsAWarning) {
  TreeText text;
  text.line("mtllib gone.mtl");
  text.tree(false, numbered);
  EXPECT_THAT(read(text.text()).report.warnings, ElementsAre(HasSubstr("'gone.mtl' is missing")));
}

TEST_F(ReadTree, FoliageCanBeLeftOut) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g leaves");
  text.leaf({0.5f, 0.1f, 2.6f}, {0.1f, 0.2f, 0});
  const Skeleton skeleton = read(text.text(), {.foliage = false});
  EXPECT_TRUE(skeleton.foliage.vertices.empty());
  EXPECT_EQ(skeleton.report.foliage_parts, 1);
  EXPECT_THAT(skeleton.report.skipped_parts,
              Contains(Pair(HasSubstr("foliage"), "left out by option")));
}

TEST_F(ReadTree, FoliageIsWhatTheUserNames) {
  TreeText text;
  text.tree(false, numbered);
  text.line("g leaves");
  text.leaf({0.5f, 0.1f, 2.6f}, {0.1f, 0.2f, 0});
  text.line("g Tags 1\nusemtl paper");
  text.leaf({0.5f, 0.1f, 2.7f}, {0.1f, 0.2f, 0});
  for (const char* names : {"tags", " Paper ", "tags,paper"}) {
    const Skeleton skeleton = read(text.text(), {.foliage_names = names});
    EXPECT_EQ(skeleton.report.foliage_parts, 1) << names;
    EXPECT_EQ(skeleton.foliage.vertices[0].z, 2.7f) << names;
    EXPECT_THAT(skeleton.report.skipped_parts,
                Contains(Pair("leaves", "not a limb, and not named as foliage")))
        << names;
  }
  EXPECT_EQ(read(text.text(), {.foliage_names = "leaves,tags"}).report.foliage_parts, 2);
}

TEST_F(ReadTree, FoliageNamesThatMeanNothingAreRefused) {
  TreeText text;
  text.tree(false, numbered);
  EXPECT_THROW(read(text.text(), {.foliage_names = "tags"}), std::invalid_argument);
  EXPECT_THROW(read(text.text(), {.foliage_names = "trunk,,twig"}), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::tree
