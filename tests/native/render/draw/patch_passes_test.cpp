#include "render/draw/patch_passes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/vec3.hpp>
#include <vector>

#include "gpu/gpu_thread.h"
#include "render/data/view.h"
#include "render/targets.h"
#include "shaders/lib/tree_shared.h"

namespace snowbough::render {
namespace {

using glm::vec3;
using glm::vec4;

constexpr int64_t kMostSquares = 16;

/// Upright squares of 0.2 m that face the camera, drawn by the shaders of trees without bark.
struct Squares : PatchSource {
  Squares(const std::vector<vec3>& middles, const std::vector<float>& levels)
      : PatchSource(middles.size()), edge_levels(levels) {
    std::vector<shared::PosedVertex> all_posed;
    std::vector<shared::TreePatch> all_patches;
    for (const vec3& middle : middles) {
      const auto first = static_cast<int32_t>(all_posed.size());
      for (const vec3 corner : {vec3(-1, 0, -1), vec3(1, 0, -1), vec3(1, 0, 1), vec3(-1, 0, 1)}) {
        shared::PosedVertex vertex{};
        vertex.position = vec4(middle + 0.1f * corner, 0.0f);
        vertex.normal = vec4(0.0f, -1.0f, 0.0f, 1.0f);
        all_posed.push_back(vertex);
      }
      shared::TreePatch patch{};
      patch.vertices = {first, first + 1, first + 2, first + 3};
      patch.edges = glm::ivec4(2 * static_cast<int32_t>(all_patches.size()));
      patch.place = {-1, 0, 0, 0};
      all_patches.push_back(patch);
    }
    vertices = gpu::Buffer(std::vector<shared::TreeVertex>(all_posed.size()));
    posed = gpu::Buffer(all_posed);
    patches = gpu::Buffer(all_patches);
  }

  std::vector<std::string> defines(DrawKind /*kind*/) const override { return {}; }
  void bind_classify(gpu::Program& program) const override {
    program.bind("TreeVertices", vertices);
    program.bind("PosedVertices", posed);
    program.bind("TreeSections", none);
    program.bind("TreeEdges", none);
    program.bind("TreePatches", patches);
    program.bind("EdgeLevels", edge_levels);
    program.bind("TileDepths", none);
    program.set("map_size", glm::ivec2(0));
    program.bind("PatchGrowths", growths);
  }
  void bind_plain(gpu::Program& program, DrawKind /*kind*/) const override {
    program.bind("TreeVertices", vertices);
    program.bind("PosedVertices", posed);
    program.bind("TreePatches", patches);
    program.bind("PatchGrowths", growths);
  }
  void bind_tessellated(gpu::Program& /*program*/, DrawKind /*kind*/) const override {}

  gpu::Buffer vertices;
  gpu::Buffer posed;
  gpu::Buffer patches;
  gpu::Buffer edge_levels;
  gpu::Buffer none{sizeof(shared::TreeEdge)};
  gpu::Buffer growths{kMostSquares * sizeof(shared::PatchGrowth)};
};

gpu::Buffer view_of_origin() {
  Camera camera;
  camera.target = vec3(0.0f);
  camera.width = camera.height = 128;
  return gpu::Buffer(std::vector<shared::TreeView>{
      camera_view(camera, RenderSettings{}, {vec3(0.0f), 5.0f, 5.0f}, false)});
}

TEST(PatchPasses, aListIsCountedByClass) {
  gpu::GpuThread::shared("")->run([] {
    Squares of({vec3(0.0f), vec3(0, -20, 0), vec3(1, 0, 0)}, {1.0f, 1.0f, 4.0f});
    PatchPasses passes("tree", 6);
    const gpu::Buffer view = view_of_origin();
    passes.classify(of, of.camera, view, 4.0f);
    const PatchCounts counts = passes.count(of.camera);
    EXPECT_EQ(counts.plain, 1);
    EXPECT_EQ(counts.dropped, 1);
    EXPECT_EQ(counts.tessellated, 1);
    EXPECT_EQ(of.sun.classes.read_all<uint32_t>(), std::vector<uint32_t>(3, 0));
  });
}

TEST(PatchPasses, plainPatchesAreDrawnAndHandedOnWhereTheyAre) {
  gpu::GpuThread::shared("")->run([] {
    Squares of({vec3(0.5f, 0, 0), vec3(0, -20, 0)}, {1.0f, 1.0f});
    PatchPasses passes("tree", 6);
    const gpu::Buffer view = view_of_origin();
    const gpu::VertexArray no_vertices;
    glBindVertexArray(no_vertices.id());
    passes.classify(of, of.camera, view, 1.0f);
    const Target target(128, 128, GL_RGBA8);
    target.begin(1.0f, 1.0f, 1.0f);
    passes.draw_plain(of, of.camera, view, {DrawKind::kWire, nullptr, vec4(0, 0, 0, 1)});
    const std::vector<uint8_t> pixels = read_color(target);
    int32_t left = 0, right = 0;
    for (int32_t i = 0; i < 128 * 128; ++i) {
      if (pixels[4 * static_cast<size_t>(i)] == 0) (i % 128 < 64 ? left : right) += 1;
    }
    EXPECT_EQ(left, 0);
    EXPECT_GT(right, 4);

    const gpu::Buffer corners(6 * static_cast<int64_t>(sizeof(vec3)));
    glEnable(GL_RASTERIZER_DISCARD);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, corners.id());
    passes.draw_plain(of, of.camera, view, {DrawKind::kCapture, nullptr, vec4(0.0f)});
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    glDisable(GL_RASTERIZER_DISCARD);
    glBindVertexArray(0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    for (const vec3& corner : corners.read_all<vec3>()) {
      EXPECT_NEAR(corner.x, 0.5f, 0.1001f);
      EXPECT_NEAR(std::abs(corner.z), 0.1f, 1e-6f);
    }
  });
}

}  // namespace
}  // namespace snowbough::render
