#include "tree/surface/builder.h"

#include <gtest/gtest.h>

#include "native/tree/built_surface.h"
#include "tree/skeleton/width.h"
#include "tree/surface/limb_path.h"

namespace snowbough::tree {
namespace {

constexpr uint32_t kTreeSeeds = 60;

void expect_same(const Surface& a, const Surface& b) {
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.quads, b.quads);
  EXPECT_EQ(a.clamped, b.clamped);
  EXPECT_EQ(a.squeezed, b.squeezed);
  ASSERT_EQ(a.junctions.size(), b.junctions.size());
  for (size_t j = 0; j < a.junctions.size(); ++j) {
    EXPECT_EQ(a.junctions[j].child, b.junctions[j].child);
    EXPECT_EQ(a.junctions[j].row, b.junctions[j].row);
    EXPECT_EQ(a.junctions[j].side, b.junctions[j].side);
  }
  for (size_t limb = 0; limb < a.limbs.size(); ++limb) {
    ASSERT_EQ(a.limbs[limb].rings.size(), b.limbs[limb].rings.size());
    for (size_t ring = 0; ring < a.limbs[limb].rings.size(); ++ring) {
      EXPECT_EQ(a.limbs[limb].rings[ring].vertices, b.limbs[limb].rings[ring].vertices);
    }
  }
}

struct PlannedTree {
  explicit PlannedTree(uint32_t seed)
      : skeleton(RandomSkeleton(seed).make()),
        scale(length_limits(skeleton)),
        paths(limb_paths(skeleton, limb_widths(skeleton, {}), scale)) {}

  Skeleton skeleton;
  LengthLimits scale;
  std::vector<LimbPath> paths;
};

TEST(BuildSurface, DoesNotDependOnTheNumberOfThreads) {
  for (uint32_t seed = 0; seed < kTreeSeeds; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const PlannedTree plan(seed);
    const std::vector<uint8_t> steps(plan.paths.size(), 0);
    expect_same(build_surface(plan.skeleton, plan.paths, plan.scale, {}, steps, 7),
                build_surface(plan.skeleton, plan.paths, plan.scale, {}, steps, 1));
  }
}

}  // namespace
}  // namespace snowbough::tree
