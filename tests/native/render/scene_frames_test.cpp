#include <gtest/gtest.h>

#include <vector>

#include "native/render/gl_calls.h"
#include "native/render/scene_things.h"

namespace snowbough::render {
namespace {

void add_both(Scene& scene) {
  scene.objects.add_tree("tree", make_tree_patches(tube(true), 0.0f), {});
  scene.objects.add_mesh("square", square(true));
}

std::vector<float> light_of(const gpu::Texture& texture) {
  std::vector<float> light(static_cast<size_t>(texture.width()) * texture.height() * 4);
  texture.read(0, GL_RGBA, GL_FLOAT, static_cast<int64_t>(light.size() * sizeof(float)),
               light.data());
  return light;
}

TEST(SceneFrames, theShadowMapIsDrawnOnlyAfterAChange) {
  with_scene([](Scene& scene) {
    add_both(scene);
    const auto light = [&](Shadows shadows) {
      return light_of(scene.frames.draw_light(square_camera(), {}, shadows));
    };
    const std::vector<float> first = light(Shadows::kDraw);
    EXPECT_EQ(light(Shadows::kIfOther), first);
    glm::mat4 aside(1.0f);
    aside[3].x = 0.3f;
    scene.objects.set_pose("tree", {aside});
    const std::vector<float> stale = light(Shadows::kKeep);
    const std::vector<float> renewed = light(Shadows::kIfOther);
    EXPECT_NE(stale, renewed);
    EXPECT_EQ(light(Shadows::kDraw), renewed);
  });
}

TEST(SceneFrames, aFrameReadsNothingBackAndNeverWaits) {
  with_scene([](Scene& scene) {
    add_both(scene);
    scene.objects.set_snow("tree", blanket(0.05f));
    scene.frames.draw_light(square_camera(), {});
    const GlWatch watch;
    Camera nearer = square_camera();
    nearer.eye *= 0.7f;
    RenderSettings settings;
    settings.snowfall.rate = 1e-5f;
    scene.frames.draw_light(nearer, settings, Shadows::kDraw);
    EXPECT_EQ(watch.seen().read_backs, 0);
    EXPECT_EQ(watch.seen().waits, 0);
    scene.frames.render(nearer, settings);  // whose pixels and statistics are asked for
    EXPECT_GT(watch.seen().read_backs, 0);
  });
}

TEST(SceneFrames, aPoseUploadsItsBonesAlone) {
  with_scene([](Scene& scene) {
    add_both(scene);
    scene.frames.draw_light(square_camera(), {});
    const auto uploaded_by = [&](auto&& work) {
      const GlWatch watch;
      work();
      return watch.seen().uploaded;
    };
    const auto frame = [&] { scene.frames.draw_light(square_camera(), {}); };
    // The views of the camera and of the sun.
    EXPECT_EQ(uploaded_by(frame), 2 * static_cast<int64_t>(sizeof(shared::TreeView)));
    glm::mat4 aside(1.0f);
    aside[3].x = 0.3f;
    EXPECT_EQ(uploaded_by([&] { scene.objects.set_pose("tree", {aside}); }),
              3 * static_cast<int64_t>(sizeof(glm::vec4)));
    EXPECT_EQ(uploaded_by(frame), 2 * static_cast<int64_t>(sizeof(shared::TreeView)));
  });
}

}  // namespace
}  // namespace snowbough::render
