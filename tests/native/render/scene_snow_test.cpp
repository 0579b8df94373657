#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "native/render/gl_calls.h"
#include "native/render/scene_things.h"
#include "shaders/lib/snow_point.h"

namespace snowbough::render {
namespace {

/// The tube lies along y, one of its vertices up.
glm::mat4 lying() {
  glm::mat4 pose(0.0f);
  pose[0] = {0, 0, 1, 0};
  pose[1] = {1, 0, 0, 0};
  pose[2] = {0, 1, 0, 0};
  pose[3].w = 1.0f;
  return pose;
}

int32_t red_pixels(const Picture& picture) {
  int32_t count = 0;
  for (size_t i = 0; i < picture.rgba.size(); i += 4) {
    count += picture.rgba[i] > 2 * picture.rgba[i + 2] ? 1 : 0;
  }
  return count;
}

TEST(SceneSnow, aMeshOfSnowIsWhiteWhateverItsMaterial) {
  with_scene([](Scene& scene) {
    scene.objects.add_mesh("square", square(false));
    const Picture red = scene.frames.render(square_camera(), {});
    EXPECT_GT(covered(red), 100);
    EXPECT_EQ(red_pixels(red), covered(red));
    scene.objects.remove("square");
    scene.objects.add_mesh("square", square(true));
    const Picture white = scene.frames.render(square_camera(), {});
    EXPECT_EQ(covered(white), covered(red));
    EXPECT_EQ(red_pixels(white), 0);
  });
}

TEST(SceneSnow, aMapMayBeSharedWithATree) {
  with_scene([](Scene& scene) {
    scene.objects.add_tree("tree", make_tree_patches(tube(true), 0.0f), {});
    const TreeSnow snow = blanket(0.1f);
    gpu::Texture map(GL_R32F, 4, 4, 0, GL_LINEAR);
    map.write(0, GL_RED, GL_FLOAT, snow.values.data());
    const GlWatch watch;
    scene.objects.share_snow("tree", map, snow.look);
    scene.frames.draw_light(square_camera(), {});
    EXPECT_EQ(watch.seen().read_backs, 0);
    const Picture shared = scene.frames.render(square_camera(), {});
    scene.objects.set_snow("tree", snow);
    EXPECT_EQ(scene.frames.render(square_camera(), {}).rgba, shared.rgba);
    scene.objects.set_snow("tree", blanket(0.0f));
    EXPECT_NE(scene.frames.render(square_camera(), {}).rgba, shared.rgba);
  });
}

TEST(SceneSnow, aTreeIsDroppedOnlyWithAllOfItsSnow) {
  with_scene([](Scene& scene) {
    scene.objects.add_tree("tree", make_tree_patches(tube(true), 0.0f), {});
    Camera aside = square_camera();
    aside.target.x = aside.eye.x = 3.0f;
    scene.frames.render(aside, {});
    EXPECT_EQ(scene.frames.statistics().dropped, 4);
    // Two metres of snow reach into the picture.
    scene.objects.set_snow("tree", blanket(2.0f));
    scene.frames.render(aside, {});
    EXPECT_LT(scene.frames.statistics().dropped, 4);
    scene.objects.set_snow("tree", blanket(0.0f));
    scene.frames.render(aside, {});
    EXPECT_EQ(scene.frames.statistics().dropped, 4);
  });
}

TEST(SceneSnow, snowIsTessellatedByTheThesissRuleWhereItLiesOnTop) {
  with_scene([](Scene& scene) {
    scene.objects.add_tree("tree", make_tree_patches(tube(true), 0.0f), {});
    scene.objects.set_pose("tree", {lying()});
    RenderSettings settings;
    settings.metric = Metric::kThesis;
    settings.max_distance = 0.1f;  // Tl is 1
    settings.snow_factor = 2000.0f;
    settings.min_pixels = 0.0f;
    const auto highest = [&] {
      scene.frames.render(square_camera(), settings);
      float found = 0.0f;
      for (const auto& edges : scene.frames.levels("tree").edges) {
        for (const float level : edges) found = std::max(found, level);
      }
      return found;
    };
    EXPECT_EQ(highest(), 1.0f);
    scene.objects.set_snow("tree", blanket(0.05f));
    const float level = highest();
    EXPECT_GT(level, 2.0f);
    settings.snow_factor = 1000.0f;
    EXPECT_NEAR(highest(), 0.5f * level, 0.01f * level);
    settings.snow_factor = 0.0f;
    EXPECT_EQ(highest(), 1.0f);
  });
}

/// Position of the snow on the tube's vertex at `rest` by shaders/lib/snow_surface.h.
glm::vec3 on_snow(const glm::vec3& rest, float thickness, const SnowLook& look) {
  const glm::vec3 normal = glm::vec3(lying() * glm::vec4(rest.x, rest.y, 0.0f, 0.0f)) / 0.1f;
  shared::SnowPoint point = shared::point_noise(rest / look.last);
  point.bumps = shared::bump_noise(rest / look.last);
  // As thick as it is wide; its circumference is that of its circle.
  point = shared::on_limb(point, 0.2f, look.last);
  const shared::SnowEdge edge = shared::snow_edge(point, thickness, look.open, normal.z);
  const float shown = shared::limb_height(point, look.style, edge, thickness, look.open);
  const float sag = shared::sagging(point, look.style, edge, thickness, shown, normal.z);
  const glm::vec3 down = normal * normal.z - glm::vec3(0.0f, 0.0f, 1.0f);
  const glm::vec3 aside = glm::length(down) < 1e-3f ? glm::vec3(0.0f) : glm::normalize(down) * sag;
  return glm::vec3(lying() * glm::vec4(rest, 1.0f)) + normal * shown + aside;
}

TEST(SceneSnow, aTreesSnowFollowsTheRuleOfAllSnow) {
  with_scene([](Scene& scene) {
    const TreeSource source = tube(true);
    scene.objects.add_tree("tree", make_tree_patches(source, 0.0f), {});
    scene.objects.set_pose("tree", {lying()});
    RenderSettings plain;
    plain.max_level = 1.0f;
    plain.min_pixels = 0.0f;
    TreeSnow snow = blanket(0.06f);
    snow.look = {0.08f, 0.1f, {1.6f, 0.4f, 1.0f, 1.9f}};
    scene.objects.set_snow("tree", snow);
    const std::vector<glm::vec3> corners = scene.frames.triangles("tree", square_camera(), plain);
    ASSERT_EQ(corners.size(), 24u);
    float tallest = 0.0f;
    for (const glm::vec3& rest : source.vertices) {
      const glm::vec3 expected = on_snow(rest, 0.06f, snow.look);
      float away = 1.0f;
      for (const glm::vec3& corner : corners) {
        away = std::min(away, glm::distance(corner, expected));
      }
      EXPECT_LT(away, 1e-5f) << rest.x << " " << rest.y << " " << rest.z;
      tallest = std::max(tallest, expected.z);
    }
    EXPECT_GT(tallest, 0.13f);
  });
}

}  // namespace
}  // namespace snowbough::render
