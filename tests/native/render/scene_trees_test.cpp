#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "native/render/scene_things.h"

namespace snowbough::render {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

void add_tube(Scene& scene, bool with_places = true) {
  scene.objects.add_tree("tree", make_tree_patches(tube(with_places), 0.0f), {});
}

TEST(SceneTrees, aTreeIsDrawnUntilItIsRemoved) {
  with_scene([](Scene& scene) {
    add_tube(scene);
    EXPECT_GT(covered(scene.frames.render(square_camera(), {})), 50);
    EXPECT_EQ(scene.frames.levels("tree").classes.size(), 4u);
    scene.objects.remove("tree");
    EXPECT_EQ(covered(scene.frames.render(square_camera(), {})), 0);
  });
}

TEST(SceneTrees, aNameIsGivenOnce) {
  with_scene([](Scene& scene) {
    add_tube(scene);
    EXPECT_THROW(add_tube(scene), std::invalid_argument);
    EXPECT_THROW(scene.objects.add_mesh("tree", {}), std::invalid_argument);
    EXPECT_THAT([&] { scene.objects.set_pose("other", {}); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("no tree 'other'")));
  });
}

TEST(SceneTrees, snowNeedsCoordinatesOnItsMap) {
  with_scene([](Scene& scene) {
    add_tube(scene, false);
    EXPECT_THAT([&] { scene.objects.set_snow("tree", blanket(0.1f)); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("no snow map coordinates")));
  });
}

TEST(SceneTrees, snowThickensATreeAndABareMapRemovesIt) {
  with_scene([](Scene& scene) {
    add_tube(scene);
    const Picture bare = scene.frames.render(square_camera(), {});
    scene.objects.set_snow("tree", blanket(0.1f));
    const Picture thick = scene.frames.render(square_camera(), {});
    EXPECT_GT(covered(thick), 3 * covered(bare) / 2);
    scene.objects.set_snow("tree", blanket(0.0f));
    EXPECT_EQ(scene.frames.render(square_camera(), {}).rgba, bare.rgba);
  });
}

}  // namespace
}  // namespace snowbough::render
