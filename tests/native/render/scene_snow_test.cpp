#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>

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

TEST(SceneSnow, aMapMayBeSharedWithMeshesButNotWithTrees) {
  with_scene([](Scene& scene) {
    add_square(scene);
    scene.add_tree("tree", make_tree_patches(tube(true), 0.0f), {});
    const auto map = std::make_shared<gpu::Texture>(GL_R32F, 4, 4, 0, GL_LINEAR);
    map->write(0, GL_RED, GL_FLOAT, kBlanket.values.data());
    EXPECT_FALSE(scene.share_snow("tree", map));
    EXPECT_TRUE(scene.share_snow("square", map));
    const Picture shared = scene.render(square_camera(), {});
    scene.set_snow("square", kBlanket);
    EXPECT_EQ(scene.render(square_camera(), {}).rgba, shared.rgba);
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
