#include "snow/surface/vertex_turns.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace snowbough::snow {
namespace {

const std::vector<glm::vec3> kRoof{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5f}, {0, 1, 0.5f}, {0.5f, 2, 0}};
const std::vector<int32_t> kFaces{0, 1, 2, 0, 2, 3, 3, 2, 4};

std::vector<glm::vec3> turned(const glm::quat& turn) {
  std::vector<glm::vec3> now;
  for (const glm::vec3& position : kRoof) now.push_back(turn * position + glm::vec3(3, 4, 5));
  return now;
}

TEST(VertexTurns, OfAMeshThatStaysAreNone) {
  for (const glm::quat& turn : vertex_turns(kFaces, kRoof, kRoof.data()))
    EXPECT_NEAR(std::abs(turn.w), 1.0f, 1e-6f);
}

TEST(VertexTurns, OfAMeshThatTurnsAsAWholeAreThatTurn) {
  const glm::quat turn = glm::normalize(glm::quat(0.8f, 0.1f, -0.3f, 0.5f));
  const std::vector<glm::vec3> now = turned(turn);
  for (const glm::quat& found : vertex_turns(kFaces, kRoof, now.data())) {
    for (const glm::vec3 axis : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}) {
      EXPECT_LT(glm::distance(found * axis, turn * axis), 1e-5f);
    }
  }
}

TEST(VertexTurns, OfVerticesWithoutFacesOrAreaAreNone) {
  const std::vector<glm::vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {9, 9, 9}};
  for (const glm::quat& turn : vertex_turns({0, 1, 2}, line, line.data())) {
    EXPECT_EQ(turn, glm::quat(1.0f, 0.0f, 0.0f, 0.0f));
  }
}

}  // namespace
}  // namespace snowbough::snow
