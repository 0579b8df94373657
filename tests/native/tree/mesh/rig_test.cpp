#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "native/tree/built_surface.h"
#include "tree/build_tree_mesh.h"
#include "tree/mesh/bones.h"
#include "tree/mesh/bones_reduce.h"
#include "tree/mesh/weights.h"

namespace snowbough::tree {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::SizeIs;

TEST(Weights, FollowFromWhereTheRingStands) {
  const Built built = build(make_skeleton({trunk(), side_branch(5.5f, 0.05f)}));
  const Armature armature =
      make_bones(make_skeleton({trunk(), side_branch(5.5f, 0.05f)}), built.paths, built.scale);
  const VertexWeights weights = make_weights(built.surface, built.paths, armature, 4);
  const LimbSurface& limb = built.surface.limbs[0];
  const int32_t joint = limb.rings[3].vertices[0];
  EXPECT_THAT(weights.indices[joint], ElementsAre(2, 3, 0, 0));
  EXPECT_THAT(weights.weights[joint], ElementsAre(0.5f, 0.5f, 0.0f, 0.0f));
  const int32_t tip = limb.rings.back().vertices[0];
  EXPECT_THAT(weights.indices[tip], ElementsAre(9, 0, 0, 0));
  EXPECT_THAT(weights.weights[tip], ElementsAre(1.0f, 0.0f, 0.0f, 0.0f));
  const int32_t knuckle = limb.rings[built.surface.junctions[0].row].vertices[0];
  EXPECT_THAT(weights.indices[knuckle], ElementsAre(5, 0, 0, 0));
  const int32_t collar = built.surface.limbs[1].rings[0].vertices[0];
  EXPECT_THAT(weights.indices[collar], ElementsAre(5, 10, 0, 0));
  EXPECT_THAT(weights.weights[collar], ElementsAre(0.5f, 0.5f, 0.0f, 0.0f));
}

TEST(Bones, AChildHangsOnTheBoneThatEndsWhereItSits) {
  const TreeMesh mesh = build_tree_mesh(make_skeleton({trunk(), side_branch(5.0f, 0.1f)}));
  ASSERT_THAT(mesh.bones.parents, SizeIs(12));
  EXPECT_EQ(mesh.bones.names[10], "b1.0");
  EXPECT_EQ(mesh.bones.parents[10], 4);
  EXPECT_EQ(mesh.bones.parents[11], 10);
  EXPECT_NEAR(mesh.bones.head_radii[0], 0.2f, 1e-6f);
}

TEST(Bones, SeveralRootsHangFromOneRootBone) {
  Branch second = trunk(0.1f);
  for (glm::vec3& p : second.points) p.x += 1.0f;
  const Skeleton skeleton = make_skeleton({trunk(), second, side_branch(5.0f, 0.1f)});
  const TreeMesh mesh = build_tree_mesh(skeleton);
  EXPECT_EQ(std::count(mesh.bones.parents.begin(), mesh.bones.parents.end(), -1), 1);
  EXPECT_EQ(mesh.bones.names[0], "root");
  EXPECT_EQ(mesh.bones.parents[1], 0);
  EXPECT_EQ(mesh.bones.parents[11], 0);
  EXPECT_EQ(mesh.bones.tails[0], mesh.bones.heads[1]);
  EXPECT_LT(mesh.bones.heads[0].z, 0.0f);
  TreeMeshOptions without;
  without.root_bone = false;
  const TreeMesh apart = build_tree_mesh(skeleton, without);
  EXPECT_EQ(std::count(apart.bones.parents.begin(), apart.bones.parents.end(), -1), 2);
  ASSERT_THAT(mesh.bones.heads, SizeIs(apart.bones.heads.size() + 1));
  for (size_t v = 0; v < mesh.bone_weights.size(); ++v) {
    // The same weights, of bones that are numbered one higher.
    EXPECT_EQ(mesh.bone_weights[v], apart.bone_weights[v]);
    for (int k = 0; k < 4 && mesh.bone_weights[v][k] > 0.0f; ++k) {
      EXPECT_EQ(mesh.bone_indices[v][k], apart.bone_indices[v][k] + 1);
    }
  }
}

TEST(Bones, OneRootNeedsNoBoneBelowIt) {
  const TreeMesh mesh = build_tree_mesh(make_skeleton({trunk(), side_branch(5.0f, 0.1f)}));
  EXPECT_EQ(mesh.bones.names[0], "b0.0");
}

TEST(Bones, ReducingHandsWeightsToTheNearestKeptAncestor) {
  const TreeMesh mesh = build_tree_mesh(make_skeleton({trunk(), side_branch(5.0f, 0.1f)}));
  const ReducedBones reduced = reduce_bones(mesh.bones, {0, 0});
  EXPECT_THAT(reduced.bones.heads, SizeIs(10));
  EXPECT_EQ(reduced.bone_map[11], 4);
  auto indices = mesh.bone_indices;
  auto weights = mesh.bone_weights;
  remap_weights(reduced.bone_map, indices, weights);
  for (const auto& weight : weights) {
    EXPECT_NEAR(weight[0] + weight[1] + weight[2] + weight[3], 1.0f, 1e-6f);
  }
}

TEST(Bones, ABudgetIsKeptAndNoBoneLosesItsParent) {
  const TreeMesh mesh = build_tree_mesh(whorl(8));
  ASSERT_THAT(mesh.bones.heads, SizeIs(26));
  const ReducedBones reduced = reduce_bones(mesh.bones, {20, -1});
  EXPECT_THAT(reduced.bones.heads, SizeIs(20));
  for (size_t i = 0; i < reduced.bones.parents.size(); ++i) {
    EXPECT_LT(reduced.bones.parents[i], static_cast<int32_t>(i));
  }
}

TEST(Bark, TheTextureKeepsItsAspect) {
  const TreeMesh mesh = build_tree_mesh(make_skeleton({trunk()}));
  const float circumference = 4.0f * std::sqrt(static_cast<float>(M_PI)) * 0.2f;
  for (size_t f = 0; f < mesh.quads.size(); ++f) {
    if (mesh.origins[f].part == FacePart::kWall) {
      EXPECT_NEAR(mesh.uv_bark[f][1].x - mesh.uv_bark[f][0].x, 0.25f, 1e-5f);
      EXPECT_NEAR(mesh.uv_bark[f][3].y - mesh.uv_bark[f][0].y, 1.0f / circumference, 1e-3f);
    }
  }
}

}  // namespace
}  // namespace snowbough::tree
