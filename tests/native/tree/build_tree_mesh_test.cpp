#include "tree/build_tree_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "native/tree/skeletons.h"
#include "tree/uv/snow_uvs.h"

namespace snowbough::tree {
namespace {

/// Progress that is reported while `work` runs.
template <typename Work>
std::vector<float> shares_of(const Work& work) {
  std::vector<float> shares;
  work([&](float share) {
    shares.push_back(share);
    return true;
  });
  return shares;
}

TEST(BuildTreeMesh, ProgressRisesFrom0To1) {
  const Skeleton skeleton = RandomSkeleton(3).make();
  const std::vector<float> shares = shares_of([&](const base::Progress& progress) {
    TreeMeshOptions options;
    options.progress = progress;
    build_tree_mesh(skeleton, options);
  });
  ASSERT_GT(shares.size(), 10u);
  EXPECT_EQ(shares.front(), 0.0f);
  EXPECT_EQ(shares.back(), 1.0f);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
}

TEST(BuildTreeMesh, StopsAtWhicheverPlaceItIsAskedTo) {
  // Cancels at every check: in the surface, its crossings and relief, and the charts.
  const Skeleton skeleton = RandomSkeleton(3).make();
  const size_t places = shares_of([&](const base::Progress& progress) {
                          TreeMeshOptions options;
                          options.progress = progress;
                          build_tree_mesh(skeleton, options);
                        }).size();
  for (size_t place = 0; place < places; ++place) {
    size_t calls = 0;
    TreeMeshOptions options;
    options.progress = [&](float) { return calls++ < place; };
    BuildReport report;
    EXPECT_THROW(build_tree_mesh(skeleton, options, &report), base::Cancelled) << "place " << place;
    EXPECT_EQ(calls, place + 1) << "it went on after the answer";
    EXPECT_EQ(report.junctions, 0);
  }
}

TEST(BuildTreeMesh, StopsWhileChartsArePacked) {
  const Skeleton skeleton = RandomSkeleton(3).make();
  TreeMesh mesh = build_tree_mesh(skeleton);
  mesh.uv_snow.clear();
  const base::Execution stop{0, [](float share) { return share < 0.5f; }};
  EXPECT_THROW(layout_snow_uvs(mesh, skeleton, 1024, stop), base::Cancelled);
  // Sized, but none of it written.
  const QuadUv none{};
  EXPECT_THAT(mesh.uv_snow, testing::Each(none));
}

TEST(BuildTreeMesh, DoesNotDependOnTheNumberOfThreads) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Skeleton skeleton = RandomSkeleton(seed).make();
    TreeMeshOptions options;
    if (seed < 3) options.detail = Detail::kDefault;
    options.threads = 1;
    const TreeMesh one = build_tree_mesh(skeleton, options);
    options.threads = 5;
    const TreeMesh five = build_tree_mesh(skeleton, options);
    EXPECT_EQ(one.vertices, five.vertices);
    EXPECT_EQ(one.quads, five.quads);
    EXPECT_EQ(one.uv_bark, five.uv_bark);
    EXPECT_EQ(one.uv_snow, five.uv_snow);
    EXPECT_EQ(one.bone_indices, five.bone_indices);
    EXPECT_EQ(one.bone_weights, five.bone_weights);
    EXPECT_EQ(one.warnings, five.warnings);
  }
}

TEST(BuildTreeMesh, ATreeWithoutRoomForItsChartsIsTheSameForAllThreads) {
  // More charts than a map of 64 texels holds: the search goes down, fails and takes a larger map.
  std::vector<Branch> branches = {trunk()};
  for (int i = 0; i < 600; ++i) {
    const glm::vec3 root(0.0f, 0.0f, 0.5f + 0.015f * static_cast<float>(i));
    const auto angle = static_cast<float>(i);
    const glm::vec3 out(std::cos(angle), std::sin(angle), 0.3f);
    branches.push_back(make_branch(0, 1, {root, root + out}, {0.01f, 0.005f}));
  }
  const Skeleton skeleton = make_skeleton(branches);
  TreeMeshOptions options;
  options.snow_resolution = 64;
  options.threads = 1;
  const TreeMesh one = build_tree_mesh(skeleton, options);
  EXPECT_THAT(one.warnings, testing::Contains(testing::HasSubstr("is too small")));
  options.threads = 3;
  EXPECT_EQ(build_tree_mesh(skeleton, options).uv_snow, one.uv_snow);
}

}  // namespace
}  // namespace snowbough::tree
