#include "snow/movement/rays/object_rays.h"

#include <gtest/gtest.h>

#include "native/snow/bench.h"
#include "snow/movement/rays/scene_rays.h"

namespace snowbough::snow {
namespace {

const glm::dvec3 kFrom(0.5, 0.25, 3.0);
const glm::dvec3 kDown(0.0, 0.0, -1.0);

TEST(ObjectRays, FollowThePoseThatIsSetLast) {
  const SceneObject object = square("upper", 2.0f, 1.0f);
  ObjectRays rays(object);
  rays.set_pose(object.positions);
  EXPECT_DOUBLE_EQ(rays.first_along(kFrom, kDown, 0.0, 10.0).distance, 2.0);
  std::vector<glm::vec3> lower = object.positions;
  for (glm::vec3& p : lower) p.z = 0.5f;
  rays.set_pose(lower);
  EXPECT_DOUBLE_EQ(rays.first_along(kFrom, kDown, 0.0, 10.0).distance, 2.5);
}

TEST(ObjectRays, KnowTheSurfaceThatTheyMeet) {
  const SceneObject object = square("upper", 2.0f, 1.0f);
  ObjectRays rays(object);
  rays.set_pose(object.positions);
  const SurfaceHit hit =
      rays.surface_at(rays.first_along(kFrom, kDown, 0.0, 10.0), 7, kFrom, kDown);
  EXPECT_EQ(hit.object, 7);
  // Corners 0, 1 and 2: -1 + 2 (w1 + w2) = 0.5 along x, -1 + 2 w2 = 0.25 along y.
  EXPECT_EQ(hit.triangle, 0);
  EXPECT_FLOAT_EQ(hit.weights.x, 0.125f);
  EXPECT_FLOAT_EQ(hit.weights.y, 0.625f);
  EXPECT_DOUBLE_EQ(hit.up, 1.0);
  EXPECT_TRUE(hit.is_open);
  EXPECT_EQ(rays.surface_at({}, 7, kFrom, kDown).object, -1);
}

TEST(SceneRays, PassTheObjectThatIsLeftOut) {
  const SceneObject upper = square("upper", 2.0f, 1.0f);
  const SceneObject lower = square("lower", 2.0f, 0.0f);
  SceneRays rays;
  rays.lay_out({&upper, &lower});
  EXPECT_EQ(rays.first_along(kFrom, kDown, 0.0).object, 0);
  const SurfaceHit below = rays.first_along(kFrom, kDown, 0.0, 10.0, &upper);
  EXPECT_EQ(below.object, 1);
  EXPECT_DOUBLE_EQ(below.distance, 3.0);
}

}  // namespace
}  // namespace snowbough::snow
