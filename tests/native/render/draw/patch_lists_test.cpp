#include "render/draw/patch_lists.h"

#include <gtest/gtest.h>

#include <vector>

#include "gpu/gpu_thread.h"
#include "render/data/view.h"
#include "shaders/lib/tree_shared.h"

namespace snowbough::render {
namespace {

using glm::ivec2;
using glm::vec3;
using glm::vec4;

/// Squares of 0.2 m around the points, each with an edge of its own for all four sides.
struct Squares {
  std::vector<shared::PosedVertex> vertices;
  std::vector<shared::TreePatch> patches;

  void add(const vec3& middle) {
    const auto first = static_cast<int32_t>(vertices.size());
    for (const vec3 corner : {vec3(-1, 0, -1), vec3(1, 0, -1), vec3(1, 0, 1), vec3(-1, 0, 1)}) {
      shared::PosedVertex vertex{};
      vertex.position = vec4(middle + 0.1f * corner, 0.0f);
      vertices.push_back(vertex);
    }
    shared::TreePatch patch{};
    patch.vertices = {first, first + 1, first + 2, first + 3};
    patch.edges = glm::ivec4(2 * static_cast<int32_t>(patches.size()));
    patches.push_back(patch);
  }
};

TEST(PatchLists, patchesAreListedByClassInTheirOrderAndDrawnByBatch) {
  gpu::GpuThread::shared("")->run([] {
    Squares of;
    const vec3 seen(0, 0, 0), behind(0, -20, 0);
    for (const vec3& middle : {seen, behind, seen, seen, behind, seen}) of.add(middle);
    const std::vector<float> levels{1.0f, 5.0f, 2.0f, 1.0f, 1.0f, 3.0f};
    Camera camera;
    camera.target = vec3(0.0f);
    const shared::TreeView seen_from =
        camera_view(camera, RenderSettings{}, {vec3(0.0f), 1.0f, 1.0f}, false);
    const gpu::Buffer view(std::vector<shared::TreeView>{seen_from});
    const gpu::Buffer posed(of.vertices), patches(of.patches), edges(levels);
    const gpu::Buffer vertices(std::vector<shared::TreeVertex>(of.vertices.size()));
    const gpu::Buffer none(sizeof(shared::TreeEdge));
    const gpu::Buffer growths(
        static_cast<int64_t>(of.patches.size() * sizeof(shared::PatchGrowth)));
    const gpu::Buffer instances(std::vector<shared::TreeInstance>(2));

    gpu::Program classify({"tree_classify.comp.glsl"});
    PatchListPasses passes;
    PatchList list;
    list.add(0, 0, 6);
    list.end_batch();
    list.add(1, 2, 3);  // the third to the fifth again
    list.end_batch();
    classify.use();
    classify.bind("ViewBlock", view);
    classify.bind("TreeInstances", instances);
    classify.bind("PosedVertices", posed);
    classify.bind("TreePatches", patches);
    classify.bind("EdgeLevels", edges);
    classify.bind("TreeVertices", vertices);
    classify.bind("TreeSections", none);
    classify.bind("TreeEdges", none);
    classify.bind("TileDepths", none);
    classify.bind("PatchGrowths", growths);
    passes.run(classify, list, 6, 5.0f);

    const PatchCounts counts = count_patches(list, 6);
    EXPECT_EQ(counts.plain, 3);
    EXPECT_EQ(counts.tessellated, 3);
    const auto plain = list.plain().read_all<ivec2>();
    const auto tessellated = list.tessellated().read_all<ivec2>();
    EXPECT_EQ(std::vector<ivec2>(plain.begin(), plain.begin() + 3),
              (std::vector<ivec2>{{0, 0}, {0, 3}, {1, 3}}));
    EXPECT_EQ(std::vector<ivec2>(tessellated.begin(), tessellated.begin() + 3),
              (std::vector<ivec2>{{0, 2}, {0, 5}, {1, 2}}));
    const auto commands = list.commands().read_all<shared::TreeDrawCommand>();
    const auto is = [&](size_t i, uint32_t count, uint32_t first) {
      EXPECT_EQ(commands[i].count, count) << i;
      EXPECT_EQ(commands[i].first, first) << i;
      EXPECT_EQ(commands[i].instances, 1u) << i;
    };
    is(0, 12, 0);
    is(1, 6, 12);
    is(2, 2, 0);
    is(3, 1, 2);
  });
}

TEST(PatchLists, aRangeStartsWithAWorkGroup) {
  gpu::GpuThread::shared("")->run([] {
    WorkList list;
    list.add(4, 0, 65);
    list.add(5, 0, 0);
    list.add(6, 7, 1);
    ASSERT_EQ(list.ranges().size(), 2u);
    EXPECT_EQ(list.ranges()[1].first_slot, 128);
    EXPECT_EQ(list.ranges()[1].first_item, 7);
    EXPECT_EQ(list.groups(), 3);
    EXPECT_EQ(list.count_of(4), 65);
    EXPECT_EQ(list.count_of(5), 0);
  });
}

}  // namespace
}  // namespace snowbough::render
