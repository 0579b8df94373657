#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
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

TEST(SceneFrames, anEmptySceneShowsTheBackground) {
  with_scene([](Scene& scene) {
    RenderSettings settings;
    settings.background = glm::vec3(1.0f, 0.0f, 0.5f);
    const Picture picture = scene.frames.render(square_camera(2), settings);
    EXPECT_EQ(std::vector<uint8_t>(picture.rgba.begin(), picture.rgba.begin() + 4),
              (std::vector<uint8_t>{255, 0, 188, 0}));
  });
}

TEST(SceneFrames, statisticsCountAllPatchesAndNameThePasses) {
  with_scene([](Scene& scene) {
    add_both(scene);
    EXPECT_THROW(scene.frames.statistics(), std::runtime_error);
    scene.frames.render(square_camera(), {});
    const FrameStatistics statistics = scene.frames.statistics();
    const auto patches = static_cast<int64_t>(scene.frames.levels("tree").classes.size());
    EXPECT_EQ(statistics.dropped + statistics.plain + statistics.tessellated, patches);
    EXPECT_GT(statistics.tessellated, 0);
    EXPECT_GE(statistics.triangles, statistics.plain);
    const auto has = [&](const char* name) {
      return std::any_of(statistics.passes.begin(), statistics.passes.end(),
                         [&](const gpu::PassTime& pass) { return pass.name == name; });
    };
    for (const char* name : {"pose", "edges", "classify", "shadow", "plain", "tessellated"}) {
      EXPECT_TRUE(has(name)) << name;
    }
  });
}

TEST(SceneFrames, trianglesAreThoseThatThePictureCounts) {
  with_scene([](Scene& scene) {
    add_both(scene);
    RenderSettings settings;
    settings.shadow_resolution = 0;
    scene.frames.render(square_camera(), settings);
    const size_t corners = scene.frames.triangles("tree", square_camera(), settings).size();
    EXPECT_EQ(static_cast<int64_t>(corners / 3) + 2, scene.frames.statistics().triangles);
    EXPECT_THROW(scene.frames.triangles("other", square_camera(), settings), std::invalid_argument);
  });
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

TEST(SceneFrames, lightIsTheMeanOfItsSamples) {
  with_scene([](Scene& scene) {
    add_both(scene);
    const LightPicture one = scene.frames.render_light(square_camera(), {}, 1);
    EXPECT_EQ(one.rgba.size(), 64u * 64 * 4);
    const LightPicture many = scene.frames.render_light(square_camera(), {}, 16);
    const auto partly = [](const LightPicture& of) {
      int32_t count = 0;
      for (size_t i = 3; i < of.rgba.size(); i += 4) {
        count += of.rgba[i] > 0.01f && of.rgba[i] < 0.99f ? 1 : 0;
      }
      return count;
    };
    EXPECT_EQ(partly(one), 0);
    EXPECT_GT(partly(many), 20);  // edges are soft
  });
}

}  // namespace
}  // namespace snowbough::render
