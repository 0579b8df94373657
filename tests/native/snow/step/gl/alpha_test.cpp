// Alpha in the occlusion pass: a fragment in a hole is missing, for occluders and receivers.
#include <gtest/gtest.h>

#include <algorithm>

#include "native/snow/bench.h"

namespace snowbough::snow {
namespace {

/// A card of 1 m at height z around the origin; u along x, v along y.
SceneObject alpha_card(const std::string& name, float z) {
  return square(name, 1.0f, z, 64, false);
}

/// Two texels side by side: the left one is opaque, the right one is a hole.
std::shared_ptr<const AlphaMask> left_half(uint32_t extension = shared::kAlphaRepeat) {
  return std::make_shared<const AlphaMask>(make_alpha_mask(2, 1, extension, {128, 127}));
}

void cut(SceneObject& object, std::shared_ptr<const AlphaMask> mask, float times = 1.0f,
         float shift = 0.0f) {
  ObjectAlpha& alpha = object.description.alpha;
  for (const glm::vec2& uv : object.description.topology.corner_uv) {
    alpha.corner_uv.push_back(uv * times + shift);
  }
  alpha.mask = {0, 0};
  alpha.masks = {std::move(mask)};
}

/// For every pixel around the cards, row by row: 1 + the object that the sky sees there, 0 = none.
/// A card is 16 pixels wide; every object has two triangles.
std::vector<int32_t> seen_from_above(const std::vector<SceneObject>& objects) {
  return gpu::GpuThread::shared()->run([&] {
    Bench bench(objects, falling({0, 0, -1}, 1.0 / 16.0));
    std::vector<TriangleRange> ranges;
    for (size_t i = 0; i < objects.size(); ++i) {
      const int32_t first = bench.scene.layout.first_triangle[i];
      const int32_t first_alpha = bench.scene.layout.first_alpha[i];
      ranges.push_back({first, 2, first_alpha >= 0, first_alpha - first});
    }
    OcclusionPass().run(bench.scene, bench.projection, bench.tiles.front(), ranges, bench.target);
    std::vector<int32_t> shown;
    for (const shared::SeenPixel& pixel : bench.visible()) {
      const uint32_t triangle = pixel.triangle & ~shared::kBackFace;
      shown.push_back(triangle == 0 ? 0 : 1 + static_cast<int32_t>(triangle - 1) / 2);
    }
    return shown;
  });
}

int64_t count_of(const std::vector<int32_t>& shown, int32_t what) {
  return std::count(shown.begin(), shown.end(), what);
}

TEST(OcclusionAlpha, TheSkySeesTheGroundThroughAHole) {
  std::vector<SceneObject> objects = {alpha_card("a", 1.0f), alpha_card("b", 0.0f)};
  cut(objects[0], left_half());
  const std::vector<int32_t> shown = seen_from_above(objects);
  EXPECT_EQ(count_of(shown, 1), 128);
  EXPECT_EQ(count_of(shown, 2), 128);
}

TEST(OcclusionAlpha, AnImageRepeatsMirrorsExtendsOrEndsBeyondItsEdge) {
  // The card shows u from 0 to 2: opaque, hole, and then repeated, mirrored, extended, or
  // nothing.
  const std::pair<uint32_t, int64_t> expected[] = {{shared::kAlphaRepeat, 128},
                                                   {shared::kAlphaMirror, 128},
                                                   {shared::kAlphaExtend, 64},
                                                   {shared::kAlphaClip, 32}};
  for (const auto& [extension, pixels] : expected) {
    std::vector<SceneObject> objects = {alpha_card("a", 1.0f)};
    cut(objects[0], left_half(extension), 2.0f);
    EXPECT_EQ(count_of(seen_from_above(objects), 1), pixels) << extension;
  }
  std::vector<SceneObject> far_off = {alpha_card("a", 1.0f)};
  cut(far_off[0], left_half(shared::kAlphaExtend), 1.0f, -5.0f);
  EXPECT_EQ(count_of(seen_from_above(far_off), 1), 256);
}

TEST(OcclusionAlpha, OnlyTrianglesWithAnImageHaveHoles) {
  std::vector<SceneObject> objects = {alpha_card("a", 1.0f)};
  cut(objects[0], std::make_shared<const AlphaMask>(make_alpha_mask(1, 1, 0, {0})));
  objects[0].description.alpha.mask = {-1, 0};
  // The diagonal's pixel centres belong to one of the two triangles.
  EXPECT_NEAR(static_cast<double>(count_of(seen_from_above(objects), 1)), 128.0, 8.0);
}

TEST(OcclusionAlpha, EachObjectUsesItsOwnImages) {
  std::vector<SceneObject> objects = {alpha_card("a", 2.0f), alpha_card("b", 1.0f),
                                      alpha_card("c", 0.0f)};
  cut(objects[0], std::make_shared<const AlphaMask>(make_alpha_mask(1, 1, 0, {0})));
  cut(objects[2], left_half());
  EXPECT_EQ(count_of(seen_from_above(objects), 2), 256);
  cut(objects[1], left_half());
  const std::vector<int32_t> shown = seen_from_above(objects);
  EXPECT_EQ(count_of(shown, 1), 0);
  EXPECT_EQ(count_of(shown, 2), 128);
  EXPECT_EQ(count_of(shown, 3), 0);  // its hole lies below b's
}

}  // namespace
}  // namespace snowbough::snow
