#include "snow/surface/cell_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/vector_relational.hpp>
#include <iostream>
#include <random>
#include <set>

namespace snowbough::snow {
namespace {

std::set<int32_t> visited(const CellGrid& grid, const glm::vec3& low, const glm::vec3& high) {
  std::set<int32_t> found;
  grid.visit(low, high, [&](int32_t box) { found.insert(box); });
  return found;
}

TEST(CellGrid, VisitsEveryBoxThatIsNear) {
  const auto seed = std::random_device{}();
  std::cout << "seed " << seed << '\n';
  std::mt19937 random(seed);
  const auto somewhere = [&] {
    std::uniform_real_distribution<float> along(-2.0f, 2.0f);
    return glm::vec3(along(random), along(random), along(random));
  };
  std::vector<CellGrid::Box> boxes;
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 a = somewhere(), b = a + 0.2f * somewhere();
    boxes.push_back({glm::min(a, b), glm::max(a, b)});
  }
  const CellGrid grid(boxes, 0.3f);
  for (int query = 0; query < 100; ++query) {
    const glm::vec3 centre = 1.3f * somewhere(), low = centre - 0.25f, high = centre + 0.25f;
    const std::set<int32_t> found = visited(grid, low, high);
    for (int32_t i = 0; i < 200; ++i) {
      const auto& [from, to] = boxes[static_cast<size_t>(i)];
      const bool meets =
          glm::all(glm::lessThanEqual(from, high)) && glm::all(glm::lessThanEqual(low, to));
      EXPECT_TRUE(!meets || found.contains(i)) << "box " << i;
    }
  }
}

TEST(CellGrid, LeavesOutWhatIsInOtherCells) {
  const CellGrid grid({{glm::vec3(0.0f), glm::vec3(0.0f)}, {glm::vec3(5.0f), glm::vec3(5.0f)}},
                      1.0f);
  EXPECT_THAT(visited(grid, glm::vec3(-0.5f), glm::vec3(0.5f)), testing::ElementsAre(0));
}

TEST(CellGrid, GrowsItsCellsForBoxesThatAreMuchLarger) {
  const CellGrid grid({{glm::vec3(0.0f), glm::vec3(1e3f)}, {glm::vec3(1e9f), glm::vec3(1e9f)}},
                      0.01f);
  EXPECT_GT(grid.size(), 1.0f);
  EXPECT_THAT(visited(grid, glm::vec3(499.0f), glm::vec3(500.0f)), testing::ElementsAre(0));
  EXPECT_THAT(visited(grid, glm::vec3(1e9f), glm::vec3(1e9f)), testing::ElementsAre(1));
}

TEST(CellGrid, KeepsItsCellsForOrdinaryBoxes) {
  EXPECT_EQ(CellGrid({{glm::vec3(-20.0f), glm::vec3(20.0f, -20.0f, 5.0f)}}, 1.0f).size(), 1.0f);
}

TEST(CellGrid, VisitsNothingFarFromAllBoxes) {
  const CellGrid grid({{glm::vec3(0.0f), glm::vec3(1.0f)}}, 0.01f);
  EXPECT_TRUE(visited(grid, glm::vec3(1e9f), glm::vec3(2e9f)).empty());
  EXPECT_TRUE(visited(grid, glm::vec3(-2e9f), glm::vec3(-1e9f)).empty());
}

TEST(CellGrid, WithoutBoxesVisitsNothing) {
  EXPECT_TRUE(visited(CellGrid({}, 1.0f), glm::vec3(-1.0f), glm::vec3(1.0f)).empty());
}

}  // namespace
}  // namespace snowbough::snow
