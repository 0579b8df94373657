#include "render/tree/bark_uvs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace snowbough::render {
namespace {

using glm::vec2;
using glm::vec4;

/// Two quads of two materials.
BarkSource two_quads() {
  BarkSource source;
  source.uv = {{vec2(0, 0), vec2(1, 0), vec2(1, 2), vec2(0, 2)},
               {vec2(3, 4), vec2(5, 6), vec2(7, 8), vec2(9, 10)}};
  source.material = {1, 0};
  source.materials = {{glm::vec3(1.0f, 0.0f, 0.0f), {}}, {glm::vec3(0.0f, 1.0f, 0.0f), {}}};
  return source;
}

TEST(BarkUvs, aPatchHasTheCornersAndTheLayerOfItsQuad) {
  const auto uvs = bark_uvs(two_quads(), {1, 0});
  ASSERT_EQ(uvs.size(), 2u);
  EXPECT_EQ(uvs[0].uv_01, vec4(3, 4, 5, 6));
  EXPECT_EQ(uvs[0].uv_23, vec4(7, 8, 9, 10));
  EXPECT_EQ(uvs[0].layer.x, 0.0f);
  EXPECT_EQ(uvs[1].layer.x, 1.0f);
}

TEST(BarkUvs, whatDoesNotFitTheTreeIsRefused) {
  const auto says = [](const BarkSource& source, const std::vector<int32_t>& quads,
                       const char* what) {
    EXPECT_THAT([&] { bark_uvs(source, quads); },
                testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr(what)));
  };
  says(two_quads(), {0, 1, 2}, "the tree's 3 quads");
  BarkSource lost = two_quads();
  lost.material[1] = 2;
  says(lost, {0, 1}, "material index 2 of quad 1 must be at least 0 and below 2");
  BarkSource bare = two_quads();
  bare.materials.clear();
  says(bare, {0, 1}, "needs at least one material");
}

}  // namespace
}  // namespace snowbough::render
