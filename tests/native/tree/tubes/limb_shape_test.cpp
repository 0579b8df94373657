#include "tree/tubes/limb_shape.h"

#include <gtest/gtest.h>

#include "native/tree/built_surface.h"

namespace snowbough::tree {
namespace {

/// Twist of a limb that leaves the trunk straight and goes on in some direction.
double twist_of(const glm::vec3& onwards) {
  const glm::vec3 root(0.0f, 0.0f, 5.5f), joint = root + glm::vec3(2.0f, 0.0f, 0.0f);
  const Branch limb = make_branch(0, 1, {root, joint, joint + onwards}, {0.02f, 0.02f, 0.02f});
  const Built built = build(make_skeleton({trunk(), limb}));
  return limb_shapes(built.surface, built.paths, {-1, 0}, 5e-4 * built.scale.height)[1]
      .hole_twist();
}

TEST(LimbShape, ABendAtTheNextJointTwistsNoHole) {
  const double straight = twist_of({2.0f, 0.0f, 0.0f});
  EXPECT_LT(straight, 0.2);
  for (const glm::vec3& onwards :
       {glm::vec3(1, 1, 1), glm::vec3(0, 2, 0.5), glm::vec3(-1, 1, -1)}) {
    EXPECT_NEAR(twist_of(onwards), straight, 0.2);
  }
}

TEST(HolePlace, AHoleInTheMiddleOfASideLiesInTheMiddle) {
  const Built built = build(make_skeleton({trunk(), side_branch(5.5f, 0.05f)}));
  const HolePlace hole = hole_place(built.surface, built.surface.junctions.front());
  EXPECT_TRUE(hole.inset);
  EXPECT_NEAR(hole.corners[0].x + hole.corners[1].x, 1.0, 1e-6);
  EXPECT_NEAR(hole.corners[0].y + hole.corners[3].y, 1.0, 1e-6);
  EXPECT_LT(hole.corners[0].x, hole.corners[1].x);
}

}  // namespace
}  // namespace snowbough::tree
