#include <gtest/gtest.h>

#include <glm/ext/matrix_transform.hpp>
#include <string>
#include <vector>

#include "native/render/gl_calls.h"
#include "native/render/scene_things.h"

namespace snowbough::render {
namespace {

using glm::mat4;
using glm::vec3;

/// A square card of leaf at the tube's upper end, of two materials.
LeafSource two_leaves() {
  LeafSource source;
  for (const float side : {-1.0f, 1.0f}) {
    for (const vec3 corner : {vec3(0.1f, 0, 0.9f), vec3(0.5f, 0, 0.9f), vec3(0.3f, 0, 1.3f)}) {
      source.positions.emplace_back(side * corner.x, corner.y, corner.z);
    }
  }
  source.uv.assign(6, glm::vec2(0.0f));
  source.bone = {0, 0};
  source.material = {0, 1};
  source.materials = {{vec3(0.1f, 0.5f, 0.1f), {}}, {vec3(0.6f, 0.3f, 0.1f), {}}};
  return source;
}

BarkSource red_bark() {
  BarkSource source;
  source.uv.assign(4, {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)});
  source.material.assign(4, 0);
  source.materials = {{vec3(0.7f, 0.1f, 0.1f), {}}};
  return source;
}

/// Places on a grid behind the origin, turned and of different sizes.
std::vector<mat4> matrices(int32_t count) {
  std::vector<mat4> made;
  for (int32_t i = 0; i < count; ++i) {
    const auto k = static_cast<float>(i);
    const vec3 at(0.9f * static_cast<float>(i % 5) - 1.8f, 0.8f * static_cast<float>(i / 5), 0.0f);
    const mat4 turned = glm::rotate(glm::translate(mat4(1.0f), at), 0.7f * k, vec3(0, 0, 1));
    made.push_back(glm::scale(turned, vec3(1.0f + 0.05f * k)));
  }
  return made;
}

std::string name_of(int32_t i) {
  return (i < 10 ? "tree 0" : "tree ") + std::to_string(i);
}

void add_tree(Scene& scene, const std::string& name) {
  scene.objects.add_tree(name, make_tree_patches(tube(true), 0.1f), {});
  scene.objects.set_leaves(name, two_leaves());
}

std::vector<uint8_t> drawn(Scene& scene) {
  return scene.frames.render(square_camera(128), {}).rgba;
}

constexpr int32_t kTrees = 20;

TEST(SceneForest, instancesLookLikeTreesOfTheirOwn) {
  with_scene([](Scene& scene) {
    const std::vector<mat4> all = matrices(kTrees);
    for (int32_t i = 0; i < kTrees; ++i) {
      add_tree(scene, name_of(i));
      scene.objects.set_pose(name_of(i), {all[static_cast<size_t>(i)]});
    }
    const auto apart = drawn(scene);
    const FrameStatistics before = scene.frames.statistics();
    for (int32_t i = 0; i < kTrees; ++i) scene.objects.remove(name_of(i));
    add_tree(scene, "tree");
    scene.objects.set_instances("tree", all);
    EXPECT_EQ(drawn(scene), apart);
    EXPECT_EQ(scene.frames.statistics().triangles, before.triangles);
    EXPECT_EQ(scene.frames.statistics().dropped, before.dropped);
    EXPECT_GT(before.plain + before.tessellated, kTrees);
    scene.objects.remove("tree");
    add_tree(scene, name_of(0));
    for (int32_t i = 1; i < kTrees; ++i) scene.objects.share_tree(name_of(i), name_of(0));
    for (int32_t i = 0; i < kTrees; ++i) {
      scene.objects.set_pose(name_of(i), {all[static_cast<size_t>(i)]});
    }
    EXPECT_EQ(drawn(scene), apart);
    scene.objects.remove(name_of(0));
    EXPECT_NE(drawn(scene), apart);
  });
}

TEST(SceneForest, eachTreeHasItsOwnPoseAndSnow) {
  with_scene([](Scene& scene) {
    const std::vector<mat4> all = matrices(3);
    const std::vector<float> depths{0.0f, 0.05f, 0.2f};
    const auto dress = [&](int32_t i) {
      const auto k = static_cast<size_t>(i);
      scene.objects.set_pose(name_of(i), {all[k]});
      scene.objects.set_snow(name_of(i), blanket(depths[k]));
    };
    for (int32_t i = 0; i < 3; ++i) {
      add_tree(scene, name_of(i));
      dress(i);
    }
    const auto apart = drawn(scene);
    for (int32_t i = 0; i < 3; ++i) scene.objects.remove(name_of(i));
    add_tree(scene, name_of(0));
    scene.objects.share_tree(name_of(1), name_of(0));
    scene.objects.share_tree(name_of(2), name_of(0));
    for (int32_t i = 0; i < 3; ++i) dress(i);
    EXPECT_EQ(drawn(scene), apart);
    scene.objects.set_snow(name_of(2), blanket(0.0f));
    EXPECT_NE(drawn(scene), apart);
  });
}

struct Calls {
  int64_t dispatches = 0;
  int64_t draws = 0;
  int32_t barriers = 0;
  bool operator==(const Calls&) const = default;
};

Calls calls_of_frame(Scene& scene) {
  scene.frames.draw_light(square_camera(), {}, Shadows::kDraw);
  const gpu::CallCounts before = gpu::call_counts();
  const GlWatch watch;
  scene.frames.draw_light(square_camera(), {}, Shadows::kDraw);
  const gpu::CallCounts after = gpu::call_counts();
  return {after.dispatches - before.dispatches, after.draws - before.draws, watch.seen().barriers};
}

TEST(SceneForest, twentyTreesNeedTheDispatchesAndDrawsOfOne) {
  with_scene([](Scene& scene) {
    add_tree(scene, "tree");
    const Calls one = calls_of_frame(scene);
    EXPECT_EQ(one.dispatches, 14);  // pose, edges, and 3 each for bark and leaves in both pictures
    EXPECT_EQ(one.draws, 8);        // plain, tessellated and two materials in both pictures
    EXPECT_EQ(one.barriers, 14);
    scene.objects.set_instances("tree", matrices(kTrees));
    EXPECT_EQ(calls_of_frame(scene), one);
    scene.objects.share_tree("other", "tree");
    scene.objects.set_snow("other", blanket(0.1f));
    EXPECT_EQ(calls_of_frame(scene), one);
  });
}

TEST(SceneForest, differentTreesAreDrawnTogether) {
  with_scene([](Scene& scene) {
    const auto add = [&](int32_t i) {
      scene.objects.add_tree(name_of(i),
                             make_tree_patches(tube(true), 0.01f * static_cast<float>(i)), {});
      scene.objects.set_pose(name_of(i), {matrices(kTrees)[static_cast<size_t>(i)]});
    };
    add(0);
    const Calls one = calls_of_frame(scene);
    EXPECT_EQ(one.draws, 4);
    for (int32_t i = 1; i < kTrees; ++i) add(i);
    EXPECT_EQ(calls_of_frame(scene), one);
    // Each set of images takes two more draws of the camera's picture.
    scene.objects.set_bark(name_of(3), red_bark());
    scene.objects.set_bark(name_of(4), red_bark());
    const Calls with_images = calls_of_frame(scene);
    EXPECT_EQ(with_images.dispatches, one.dispatches);
    EXPECT_EQ(with_images.draws, one.draws + 4);
  });
}

TEST(SceneForest, smallBuffersSplitTheChainAndKeepThePicture) {
  std::vector<uint8_t> whole;
  with_scene([&](Scene& scene) {
    add_tree(scene, "tree");
    scene.objects.set_instances("tree", matrices(kTrees));
    whole = drawn(scene);
  });
  gpu::GpuThread::shared("")->run([&] {
    // Room for the leaves and the posed vertices of a few trees.
    SceneObjects objects(4096);
    FrameDrawing frames(objects);
    for (int32_t i = 0; i < kTrees; ++i) {
      objects.add_tree(name_of(i), make_tree_patches(tube(true), 0.1f), {});
      objects.set_leaves(name_of(i), two_leaves());
      objects.set_instances(name_of(i), {matrices(kTrees)[static_cast<size_t>(i)]});
    }
    EXPECT_EQ(frames.render(square_camera(128), {}).rgba, whole);
    EXPECT_GT(frames.statistics().calls.dispatches, 14);
  });
}

TEST(SceneForest, treesOutsideThePictureCostNothing) {
  with_scene([](Scene& scene) {
    add_tree(scene, "tree");
    RenderSettings settings;
    settings.shadow_resolution = 0;
    scene.objects.set_instances("tree", {glm::translate(mat4(1.0f), vec3(0, -40, 0))});
    EXPECT_EQ(covered(scene.frames.render(square_camera(), settings)), 0);
    EXPECT_EQ(scene.frames.statistics().calls.dispatches, 0);
    EXPECT_EQ(scene.frames.statistics().dropped, 4);
  });
}

}  // namespace
}  // namespace snowbough::render
