#include "render/draw/posed_bounds.h"

#include <gtest/gtest.h>

#include <glm/ext/matrix_transform.hpp>

namespace snowbough::render {
namespace {

using glm::mat4;
using glm::vec3;

TEST(PosedBounds, aBoxIsEmptyUntilAPointIsIn) {
  Box box;
  EXPECT_TRUE(box.is_empty());
  box.add(Box());
  EXPECT_TRUE(box.is_empty());
  box.add({1, 2, 3});
  EXPECT_FALSE(box.is_empty());
  EXPECT_EQ(box.size(), vec3(0.0f));
}

TEST(PosedBounds, aTurnedBoxReachesAsFarAsItsCorners) {
  Box box;
  box.add({-1, -1, 0});
  box.add({1, 1, 0});
  const Box turned = box.moved(glm::rotate(mat4(1.0f), 0.785398f, vec3(0, 0, 1)));
  EXPECT_NEAR(turned.high.x, 1.41421f, 1e-4f);
  EXPECT_NEAR(turned.low.y, -1.41421f, 1e-4f);
}

TEST(PosedBounds, verticesMoveWithTheirBone) {
  PosedBounds bounds(2);
  bounds.add(0, {0, 0, 0});
  bounds.add(1, {0, 0, 1});
  const mat4 aside = glm::translate(mat4(1.0f), vec3(3, 0, 0));
  const Box posed = bounds.posed(std::vector<mat4>{mat4(1.0f), aside});
  EXPECT_EQ(posed.low, vec3(0, 0, 0));
  EXPECT_EQ(posed.high, vec3(3, 0, 1));
}

TEST(PosedBounds, bonesThatCarryNothingDoNotCount) {
  PosedBounds bounds(2);
  bounds.add(0, {1, 1, 1});
  const mat4 away = glm::translate(mat4(1.0f), vec3(99, 0, 0));
  EXPECT_EQ(bounds.posed(std::vector<mat4>{mat4(1.0f), away}).high, vec3(1, 1, 1));
}

}  // namespace
}  // namespace snowbough::render
