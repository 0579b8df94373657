#include "render/snow/snow_passes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "gpu/gpu_thread.h"

namespace snowbough::render {
namespace {

using glm::vec2;
using glm::vec3;

/// A level square of a metre whose map reaches from border to border.
SnowSource square() {
  SnowSource source;
  source.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  source.triangles = {{0, 1, 2}, {0, 2, 3}};
  source.uv = {{vec2(0, 0), vec2(1, 0), vec2(1, 1)}, {vec2(0, 0), vec2(1, 1), vec2(0, 1)}};
  source.resolution = 64;
  return source;
}

std::shared_ptr<gpu::Texture> map_of(const std::vector<float>& heights) {
  auto map = std::make_shared<gpu::Texture>(GL_R32F, 64, 64, 0, GL_LINEAR);
  map->write(0, GL_RED, GL_FLOAT, heights.data());
  return map;
}

TEST(SnowPasses, anEvenBlanketRaisesVerticesAwayFromItsEnd) {
  gpu::GpuThread::shared("")->run([] {
    const SnowMesh mesh(square());
    SnowBuffers buffers(mesh.patches(), glm::vec4(1.0f));
    buffers.set_map(map_of(std::vector<float>(64 * 64, 0.05f)));
    SnowPasses passes;
    passes.lay(buffers);
    int raised = 0;
    for (const shared::SnowPoint& point : buffers.points.read_all<shared::SnowPoint>()) {
      const vec3 p(point.position);
      const float end = std::min({p.x, p.y, 1.0f - p.x, 1.0f - p.y});
      EXPECT_LE(p.z, 0.05f + 1e-6f);
      if (end < 0.2f) continue;
      EXPECT_NEAR(p.z, 0.05f, 1e-6f);
      ++raised;
    }
    EXPECT_GT(raised, 0);
    EXPECT_FALSE(buffers.map_is_new || buffers.pose_is_new);
  });
}

TEST(SnowPasses, aPatchKnowsTheDeepestSnowOfItsTiles) {
  gpu::GpuThread::shared("")->run([] {
    const SnowMesh mesh(square());
    SnowBuffers buffers(mesh.patches(), glm::vec4(1.0f));
    std::vector<float> heights(64 * 64, 0.0f);
    heights[4 * 64 + 60] = -0.25f;  // on the back, at the lower right
    buffers.set_map(map_of(heights));
    SnowPasses passes;
    passes.lay(buffers);
    const auto depths = buffers.patch_depths.read_all<float>();
    const auto& patches = mesh.patches().patches;
    ASSERT_EQ(depths.size(), patches.size());
    EXPECT_EQ(*std::max_element(depths.begin(), depths.end()), 0.25f);
    for (size_t i = 0; i < patches.size(); ++i) {
      const shared::SnowPatch& of = patches[i];
      const float left = std::max({of.uv_01.x, of.uv_01.z, of.uv_2.x});
      if (left >= 0.7f) continue;
      EXPECT_EQ(depths[i], 0.0f) << "patch " << i;
    }
  });
}

}  // namespace
}  // namespace snowbough::render
