#include "snow/texels/merge_vertices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;

std::vector<int32_t> merged_triangle(const std::vector<glm::vec3>& positions) {
  MapTopology topology;
  topology.vertex_count = static_cast<int32_t>(positions.size());
  topology.triangles = {0, 1, 2};
  return merge_vertices(topology, positions).triangles;
}

TEST(MergedVertices, MergesCoincidentVertices) {
  EXPECT_THAT(merged_triangle({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}), ElementsAre(0, 1, 1));
}

TEST(MergedVertices, MergesAMeshThatIsOnePointFarFromTheOrigin) {
  const glm::vec3 far(1e9f, -1e9f, 1e3f);
  EXPECT_THAT(merged_triangle({far, far, far}), ElementsAre(0, 0, 0));
}

}  // namespace
}  // namespace snowbough::snow
