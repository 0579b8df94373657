#include "snow/scene/scene_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;

/// Two triangles that share an edge, or two that share nothing.
SceneObject object(const std::string& name, bool receive, int32_t resolution, bool in_one_piece) {
  SceneObject made;
  made.description.name = name;
  made.description.receive = receive;
  MapTopology& topology = made.description.topology;
  topology.resolution = resolution;
  topology.triangles = in_one_piece ? std::vector<int32_t>{0, 1, 2, 0, 2, 3}
                                    : std::vector<int32_t>{0, 1, 2, 3, 4, 5};
  topology.vertex_count = in_one_piece ? 4 : 6;
  topology.corner_uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  made.positions.resize(static_cast<size_t>(topology.vertex_count));
  return made;
}

ObjectAlpha alpha(const std::shared_ptr<const AlphaMask>& mask) {
  ObjectAlpha made;
  made.corner_uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  made.mask = {0, -1};
  made.masks = {mask};
  return made;
}

/// cart: a receiver with a map of 128; fence: no receiver, in two pieces; ground: one of 64.
struct ThreeObjects {
  SceneObject cart = object("cart", true, 128, true);
  SceneObject fence = object("fence", false, 64, false);
  SceneObject ground = object("ground", true, 64, true);

  SceneLayout laid_out() const { return lay_out_scene({&cart, &fence, &ground}, 8); }
};

TEST(SceneLayout, PutsObjectsOneBehindTheOther) {
  const SceneLayout layout = ThreeObjects().laid_out();
  EXPECT_THAT(layout.first_vertex, ElementsAre(0, 4, 10));
  EXPECT_THAT(layout.first_triangle, ElementsAre(0, 2, 4));
  EXPECT_EQ(layout.vertex_count, 14);
  ASSERT_EQ(layout.triangles.size(), 6u);
  EXPECT_EQ(layout.triangles[3].a, 7u);
  EXPECT_EQ(layout.triangles[3].c, 9u);
  EXPECT_EQ(layout.triangles[5].b, 12u);
}

TEST(SceneLayout, GivesSmallMapsTheFirstSlotsAndNamesTheReceivers) {
  const SceneLayout layout = ThreeObjects().laid_out();
  EXPECT_THAT(layout.plan.slot, ElementsAre(1, 2, 0));
  EXPECT_THAT(objects_by_slot(layout.plan), ElementsAre(2, 0, 1));
  EXPECT_EQ(layout.triangles[0].object, 1u | shared::kReceives);
  EXPECT_EQ(layout.triangles[2].object, 2u);
  EXPECT_EQ(layout.triangles[4].object, 0u | shared::kReceives);
}

TEST(SceneLayout, HoldsReceiversMapTrianglesBySlot) {
  const SceneLayout layout = ThreeObjects().laid_out();
  EXPECT_EQ(layout.map_triangles.size(), 4u);
  // The ground's first triangle is the scene's fifth and the first on a map, the cart's the
  // reverse.
  EXPECT_EQ(layout.map_offsets[0], -4);
  EXPECT_EQ(layout.map_offsets[1], 2);
}

TEST(SceneLayout, NumbersSheetsThroughAllObjects) {
  EXPECT_THAT(ThreeObjects().laid_out().triangle_sheets, ElementsAre(0, 0, 1, 2, 3, 3));
}

TEST(SceneLayout, KeepsAMaskThatTwoObjectsShareOnce) {
  const auto mask = std::make_shared<const AlphaMask>(
      make_alpha_mask(2, 1, shared::kAlphaRepeat, std::vector<uint8_t>{255, 0}));
  ThreeObjects scene;
  scene.cart.description.alpha = alpha(mask);
  scene.ground.description.alpha = alpha(mask);
  const SceneLayout layout = scene.laid_out();
  EXPECT_THAT(layout.first_alpha, ElementsAre(0, -1, 2));
  EXPECT_EQ(layout.alpha_headers.size(), 1u);
  EXPECT_THAT(layout.alpha_bits, ElementsAre(1u));
  ASSERT_EQ(layout.alpha_triangles.size(), 4u);
  EXPECT_EQ(layout.alpha_triangles[0].mask, 1u);
  EXPECT_EQ(layout.alpha_triangles[1].mask, 0u);
  EXPECT_EQ(layout.alpha_triangles[2].mask, 1u);
}

}  // namespace
}  // namespace snowbough::snow
