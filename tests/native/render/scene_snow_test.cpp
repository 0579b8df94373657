#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "native/render/gl_calls.h"
#include "native/render/scene_things.h"

namespace snowbough::render {
namespace {

int32_t red_pixels(const Picture& picture) {
  int32_t count = 0;
  for (size_t i = 0; i < picture.rgba.size(); i += 4) {
    count += picture.rgba[i] > 2 * picture.rgba[i + 2] ? 1 : 0;
  }
  return count;
}

TEST(SceneSnow, aMeshOfSnowIsWhiteWhateverItsMaterial) {
  with_scene([](Scene& scene) {
    scene.add_mesh("square", square(false));
    const Picture red = scene.render(square_camera(), {});
    EXPECT_GT(covered(red), 100);
    EXPECT_EQ(red_pixels(red), covered(red));
    scene.remove("square");
    scene.add_mesh("square", square(true));
    const Picture white = scene.render(square_camera(), {});
    EXPECT_EQ(covered(white), covered(red));
    EXPECT_EQ(red_pixels(white), 0);
  });
}

TEST(SceneSnow, aMapMayBeSharedWithATree) {
  with_scene([](Scene& scene) {
    scene.add_tree("tree", make_tree_patches(tube(true), 0.0f), {});
    const TreeSnow snow = blanket(0.1f);
    const auto map = std::make_shared<gpu::Texture>(GL_R32F, 4, 4, 0, GL_LINEAR);
    map->write(0, GL_RED, GL_FLOAT, snow.values.data());
    const GlWatch watch;
    scene.share_snow("tree", map, snow.depths);
    scene.draw_light(square_camera(), {});
    EXPECT_EQ(watch.seen().read_backs, 0);
    const Picture shared = scene.render(square_camera(), {});
    scene.set_snow("tree", snow);
    EXPECT_EQ(scene.render(square_camera(), {}).rgba, shared.rgba);
    scene.set_snow("tree", blanket(0.0f));
    EXPECT_NE(scene.render(square_camera(), {}).rgba, shared.rgba);
  });
}

TEST(SceneSnow, aTreeIsDroppedOnlyWithAllOfItsSnow) {
  with_scene([](Scene& scene) {
    scene.add_tree("tree", make_tree_patches(tube(true), 0.0f), {});
    Camera aside = square_camera();
    aside.target.x = aside.eye.x = 3.0f;
    scene.render(aside, {});
    EXPECT_EQ(scene.statistics().dropped, 4);
    // Two metres of snow reach into the picture.
    scene.set_snow("tree", blanket(2.0f));
    scene.render(aside, {});
    EXPECT_LT(scene.statistics().dropped, 4);
    scene.set_snow("tree", blanket(0.0f));
    scene.render(aside, {});
    EXPECT_EQ(scene.statistics().dropped, 4);
  });
}

TEST(SceneSnow, snowIsTessellatedByTheThesissRuleWhereItLiesOnTop) {
  with_scene([](Scene& scene) {
    scene.add_tree("tree", make_tree_patches(tube(true), 0.0f), {});
    glm::mat4 lying(0.0f);  // along y, a side up
    lying[0] = {0, 0, -1, 0};
    lying[1] = {-1, 0, 0, 0};
    lying[2] = {0, 1, 0, 0};
    lying[3].w = 1.0f;
    scene.set_pose("tree", {lying});
    RenderSettings settings;
    settings.metric = Metric::kThesis;
    settings.max_distance = 0.1f;  // Tl is 1
    settings.snow_factor = 2000.0f;
    settings.min_pixels = 0.0f;
    const auto highest = [&] {
      scene.render(square_camera(), settings);
      float found = 0.0f;
      for (const auto& edges : scene.levels("tree").edges) {
        for (const float level : edges) found = std::max(found, level);
      }
      return found;
    };
    EXPECT_EQ(highest(), 1.0f);
    scene.set_snow("tree", blanket(0.05f));
    const float level = highest();
    EXPECT_GT(level, 2.0f);
    settings.snow_factor = 1000.0f;
    EXPECT_NEAR(highest(), 0.5f * level, 0.01f * level);
    settings.snow_factor = 0.0f;
    EXPECT_EQ(highest(), 1.0f);
  });
}

TEST(SceneSnow, depthIsThatOfOpenGLsBuffer) {
  with_scene([](Scene& scene) {
    scene.add_mesh("square", square(true));
    Camera camera = square_camera(5);
    camera.eye = {0.0f, 0.0f, 3.0f};
    camera.target = glm::vec3(0.0f);
    camera.up = {0.0f, 1.0f, 0.0f};
    camera.near = 1.0f;
    camera.far = 9.0f;
    const DepthPicture found = scene.render_depth(camera, {});
    // f (z - n) / (z (f - n)) of z = 3.
    EXPECT_NEAR(found.depth[12], 0.75f, 1e-5f);
    EXPECT_EQ(found.depth[0], 1.0f);
  });
}

}  // namespace
}  // namespace snowbough::render
