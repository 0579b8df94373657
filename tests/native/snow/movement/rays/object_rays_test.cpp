#include "snow/movement/rays/object_rays.h"

#include <gtest/gtest.h>

#include <ctime>
#include <glm/geometric.hpp>

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
  const RayHit hit = rays.hit_at(rays.first_along(kFrom, kDown, 0.0, 10.0), 7, kFrom, kDown);
  EXPECT_EQ(hit.object, 7);
  // Corners 0, 1 and 2: -1 + 2 (w1 + w2) = 0.5 along x, -1 + 2 w2 = 0.25 along y.
  EXPECT_EQ(hit.triangle, 0);
  EXPECT_FLOAT_EQ(hit.weights.x, 0.125f);
  EXPECT_FLOAT_EQ(hit.weights.y, 0.625f);
  EXPECT_DOUBLE_EQ(hit.up, 1.0);
  EXPECT_TRUE(hit.is_open);
  EXPECT_EQ(rays.hit_at({}, 7, kFrom, kDown).object, -1);
}

TEST(SceneRays, PassTheObjectThatIsLeftOut) {
  const SceneObject upper = square("upper", 2.0f, 1.0f);
  const SceneObject lower = square("lower", 2.0f, 0.0f);
  SceneRays rays;
  rays.lay_out({&upper, &lower});
  EXPECT_EQ(rays.first_along(kFrom, kDown, 0.0).object, 0);
  const RayHit below = rays.first_along(kFrom, kDown, 0.0, 10.0, &upper);
  EXPECT_EQ(below.object, 1);
  EXPECT_DOUBLE_EQ(below.distance, 3.0);
}

void move(SceneObject& object, const glm::vec3& way) {
  for (glm::vec3& point : object.positions) point += way;
  object.bounds.low += way;
  object.bounds.high += way;
}

/// Level squares of 2 m, in rows of 50 that are 3 m apart.
std::vector<SceneObject> rows_of(int32_t count) {
  std::vector<SceneObject> objects;
  for (int32_t i = 0; i < count; ++i) {
    objects.push_back(square("square", 2.0f, 0.1f * static_cast<float>(i % 7), 8, false));
    const glm::vec3 way(3.0f * static_cast<float>(i % 50), 3.0f * static_cast<float>(i / 50), 0.0f);
    move(objects.back(), way);
  }
  return objects;
}

std::vector<const SceneObject*> pointers_to(const std::vector<SceneObject>& objects) {
  std::vector<const SceneObject*> pointers;
  for (const SceneObject& object : objects) pointers.push_back(&object);
  return pointers;
}

TEST(SceneRays, MeetTheNearestOfManyObjects) {
  std::vector<SceneObject> objects = rows_of(333);
  SceneRays rays;
  rays.lay_out(pointers_to(objects));
  for (int32_t i = 0; i < 333; ++i) {
    const glm::dvec3 above(3.0 * (i % 50) + 0.5, 3.0 * (i / 50) + 0.5, 3.0);
    const RayHit hit = rays.first_along(above, kDown, 0.0);
    EXPECT_EQ(hit.object, i);
    EXPECT_NEAR(hit.distance, 3.0 - 0.1 * (i % 7), 1e-6);
  }
  EXPECT_EQ(rays.first_along({1.5, 1.5, 3.0}, kDown, 0.0).object, -1);
  // Along a row, through squares of one height.
  EXPECT_EQ(
      rays.first_along({-5.0, 0.5, 0.1}, glm::normalize(glm::dvec3(3.0, 0.0, -0.05)), 0.0).object,
      0);
}

TEST(SceneRays, MeetAnObjectWhereItHasGone) {
  std::vector<SceneObject> objects = rows_of(100);
  SceneRays rays;
  rays.lay_out(pointers_to(objects));
  move(objects[30], {-600.0f, 0.0f, 0.0f});
  rays.forget_pose(30);
  EXPECT_EQ(rays.first_along({90.0, 0.5, 3.0}, kDown, 0.0).object, -1);
  EXPECT_EQ(rays.first_along({-510.0, 0.5, 3.0}, kDown, 0.0).object, 30);
  EXPECT_EQ(rays.first_along({93.0, 0.5, 3.0}, kDown, 0.0).object, 31);
}

TEST(SceneRays, MeetTheFirstOfEquallyNearObjects) {
  // Three that overlap, the last one in the list farthest to the left.
  std::vector<SceneObject> objects;
  for (const float x : {1.0f, 0.0f, -1.0f}) {
    objects.push_back(square("square", 4.0f, 0.0f, 8, false));
    move(objects.back(), {x, 0.0f, 0.0f});
  }
  SceneRays rays;
  rays.lay_out(pointers_to(objects));
  EXPECT_EQ(rays.first_along(kFrom, kDown, 0.0).object, 0);
  EXPECT_EQ(rays.first_along(kFrom, kDown, 0.0, 10.0, &objects[0]).object, 1);
}

/// Processor time of 20,000 rays at ten of so many objects.
double seconds_of_rays(int32_t count) {
  const std::vector<SceneObject> objects = rows_of(count);
  SceneRays rays;
  rays.lay_out(pointers_to(objects));
  std::clock_t begun = 0;
  for (int32_t i = -10; i < 20000; ++i) {
    if (i == 0) begun = std::clock();  // the trees of objects are built
    EXPECT_GE(rays.first_along({3.0 * ((i + 10) % 10), 0.0, 3.0}, kDown, 0.0).object, 0);
  }
  return static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
}

TEST(SceneRays, TakeAboutAsLongAmongManyObjectsAsAmongFew) {
  EXPECT_LT(seconds_of_rays(4000), 10.0 * seconds_of_rays(40) + 0.005);
}

}  // namespace
}  // namespace snowbough::snow
