#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>

#include "native/render/gl_calls.h"
#include "native/render/scene_things.h"

namespace snowbough::render {
namespace {

const HeightMap kBlanket{4, 4, std::vector<float>(16, 0.1f)};

void add_square(Scene& scene, bool draws_base = true) {
  scene.add_snow_mesh("square", SnowMesh(snow_square()), glm::vec3(0.8f, 0.0f, 0.0f), draws_base);
}

int32_t red_pixels(const Picture& picture) {
  int32_t count = 0;
  for (size_t i = 0; i < picture.rgba.size(); i += 4) {
    count += picture.rgba[i] > 2 * picture.rgba[i + 2] ? 1 : 0;
  }
  return count;
}

TEST(SceneSnow, aMeshIsBareUntilItHasAMap) {
  with_scene([](Scene& scene) {
    add_square(scene);
    const Picture bare = scene.render(square_camera(), {});
    EXPECT_EQ(red_pixels(bare), covered(bare));
    scene.set_snow("square", kBlanket);
    const Picture white = scene.render(square_camera(), {});
    EXPECT_LT(red_pixels(white), covered(white) / 10);
  });
}

TEST(SceneSnow, aLayerIsThereOnlyWhereItHides) {
  with_scene([](Scene& scene) {
    add_square(scene, false);
    EXPECT_EQ(red_pixels(scene.render(square_camera(), {})), 0);
    const Picture none = scene.render(square_camera(), {});
    scene.set_snow("square", kBlanket);
    EXPECT_NE(scene.render(square_camera(), {}).rgba, none.rgba);
  });
}

TEST(SceneSnow, aMapMayBeSharedWithMeshesAndTrees) {
  with_scene([](Scene& scene) {
    add_square(scene);
    scene.add_tree("tree", make_tree_patches(tube(true), 0.0f), {});
    const auto map = std::make_shared<gpu::Texture>(GL_R32F, 4, 4, 0, GL_LINEAR);
    map->write(0, GL_RED, GL_FLOAT, kBlanket.values.data());
    const GlWatch watch;
    scene.share_snow("tree", map);
    scene.share_snow("square", map);
    scene.draw_light(square_camera(), {});
    EXPECT_EQ(watch.seen().read_backs, 0);
    const Picture shared = scene.render(square_camera(), {});
    scene.set_snow("square", kBlanket);
    scene.set_snow("tree", kBlanket);
    EXPECT_EQ(scene.render(square_camera(), {}).rgba, shared.rgba);
    scene.set_snow("tree", {4, 4, std::vector<float>(16, 0.0f)});
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
    scene.set_snow("tree", {4, 4, std::vector<float>(16, 2.0f)});
    scene.render(aside, {});
    EXPECT_LT(scene.statistics().dropped, 4);
    scene.set_snow("tree", {4, 4, std::vector<float>(16, 0.0f)});
    scene.render(aside, {});
    EXPECT_EQ(scene.statistics().dropped, 4);
  });
}

TEST(SceneSnow, levelsAreThoseOfTheLastPicture) {
  with_scene([](Scene& scene) {
    add_square(scene);
    EXPECT_THROW(scene.snow_levels("square"), std::runtime_error);
    scene.set_snow("square", kBlanket);
    scene.render(square_camera(), {});
    const SnowLevels levels = scene.snow_levels("square");
    EXPECT_EQ(levels.classes.size(), levels.edges.size());
    EXPECT_GT(levels.edges[0][0], 1.0f);
    EXPECT_THROW(scene.snow_levels("other"), std::invalid_argument);
  });
}

}  // namespace
}  // namespace snowbough::render
