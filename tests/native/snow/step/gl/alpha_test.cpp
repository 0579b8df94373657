// Alpha in the occlusion pass: a fragment in a hole is missing, for occluders and receivers.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/vec4.hpp>

#include "gpu/gpu_thread.h"
#include "snow/scene/memory_estimate.h"
#include "snow/step/gl/occlusion.h"
#include "snow/step/gl/passes.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow {
namespace {

/// A card of 1 m at height z around the origin; u along x, v along y.
SceneObject alpha_card(const std::string& name, float z) {
  SceneObject object;
  object.description.name = name;
  object.description.receive = false;
  MapTopology& topology = object.description.topology;
  topology.triangles = {0, 1, 2, 0, 2, 3};
  topology.corner_uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  topology.vertex_count = 4;
  object.positions = {{-0.5f, -0.5f, z}, {0.5f, -0.5f, z}, {0.5f, 0.5f, z}, {-0.5f, 0.5f, z}};
  object.bounds.include(glm::dvec3(-0.5, -0.5, z));
  object.bounds.include(glm::dvec3(0.5, 0.5, z));
  return object;
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
/// A card is 16 pixels wide; every object has two triangles. `width`: pixels in a row.
std::vector<int32_t> seen_from_above(const std::vector<SceneObject>& objects,
                                     size_t* width = nullptr) {
  return gpu::GpuThread::shared()->run([&] {
    std::vector<const SceneObject*> pointers;
    Bounds bounds;
    for (const SceneObject& object : objects) {
      pointers.push_back(&object);
      bounds.include(object.bounds);
    }
    SceneBuffers scene = build_scene_buffers(pointers, gpu::GpuThread::shared()->info());
    std::vector<TriangleRange> ranges;
    for (size_t i = 0; i < objects.size(); ++i) {
      scene.positions.write(int64_t{12} * scene.layout.first_vertex[i],
                            static_cast<int64_t>(objects[i].positions.size()) * 12,
                            objects[i].positions.data());
      const int32_t first = scene.layout.first_triangle[i];
      ranges.push_back(
          {first, 2, scene.layout.first_alpha[i] >= 0, scene.layout.first_alpha[i] - first});
    }
    FallSettings settings;
    settings.pixel_size = 1.0 / 16.0;
    settings.depth = 0.01;
    const shared::ProjectionFrame frame = make_projection_frame(settings, bounds);
    const gpu::Buffer projection(sizeof frame, &frame);
    const std::vector<Tile> tiles = make_tiles({pixels_of(bounds, frame)}, 2048);
    TriangleSetupPass().run(scene, projection);
    OcclusionTarget target;
    OcclusionPass().run(scene, projection, tiles.front(), ranges, target);
    const auto all = target.visible.read_all<shared::SeenPixel>();
    const glm::ivec2 size = tiles.front().with_margin().size();
    if (width != nullptr) {
      *width = static_cast<size_t>(size.x);
    }
    std::vector<int32_t> shown;
    for (int32_t y = 0; y < size.y; ++y) {
      for (int32_t x = 0; x < size.x; ++x) {
        const uint32_t triangle =
            all[static_cast<size_t>(y * size.x + x)].triangle & ~shared::kBackFace;
        shown.push_back(triangle == 0 ? 0 : 1 + static_cast<int32_t>(triangle - 1) / 2);
      }
    }
    return shown;
  });
}

int64_t count_of(const std::vector<int32_t>& shown, int32_t what) {
  return std::count(shown.begin(), shown.end(), what);
}

TEST(OcclusionAlpha, AnOpaqueCardHidesAllThatLiesBelow) {
  const std::vector<int32_t> shown =
      seen_from_above({alpha_card("a", 1.0f), alpha_card("b", 0.0f)});
  EXPECT_EQ(count_of(shown, 1), 256);
  EXPECT_EQ(count_of(shown, 2), 0);
}

TEST(OcclusionAlpha, TheSkySeesTheGroundThroughAHole) {
  std::vector<SceneObject> objects = {alpha_card("a", 1.0f), alpha_card("b", 0.0f)};
  cut(objects[0], left_half());
  const std::vector<int32_t> shown = seen_from_above(objects);
  EXPECT_EQ(count_of(shown, 1), 128);
  EXPECT_EQ(count_of(shown, 2), 128);
}

TEST(OcclusionAlpha, AHoleIsWhereTheImageHasIt) {
  std::vector<SceneObject> objects = {alpha_card("a", 1.0f), alpha_card("b", 0.0f)};
  cut(objects[0], left_half());
  size_t width = 0;
  const std::vector<int32_t> shown = seen_from_above(objects, &width);
  const size_t first =
      static_cast<size_t>(std::find(shown.begin(), shown.end(), 1) - shown.begin());
  for (size_t i = first; i < shown.size(); ++i) {
    if (shown[i] != 0) {
      const size_t column = (i - first) % width;
      ASSERT_EQ(shown[i], column < 8 ? 1 : 2) << "column " << column;
    }
  }
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

TEST(OcclusionAlpha, MemoryCountsAMaskThatTwoObjectsShareOnce) {
  const auto mask = std::make_shared<const AlphaMask>(
      make_alpha_mask(1024, 1024, 0, std::vector<uint8_t>(1 << 20, 255)));
  SceneObject a = alpha_card("a", 1.0f);
  SceneObject b = alpha_card("b", 0.0f);
  const int64_t opaque = estimate_shared_memory({&a, &b}).geometry;
  cut(a, mask);
  cut(b, mask);
  EXPECT_EQ(estimate_shared_memory({&a, &b}).geometry - opaque, 4 * 32 + 16 + (1 << 17));
}

TEST(AlphaMask, HalfAlphaIsThere) {
  EXPECT_EQ(make_alpha_mask(3, 1, 0, {127, 128, 255}).bits, std::vector<uint32_t>{0b110u});
}

TEST(AlphaMask, WhatDoesNotFitIsRefused) {
  EXPECT_THROW(make_alpha_mask(0, 1, 0, {}), std::invalid_argument);
  EXPECT_THROW(make_alpha_mask(2, 2, 0, {0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(alpha_extension("repeat"), std::invalid_argument);
  SceneObject object = alpha_card("a", 0.0f);
  cut(object, left_half());
  EXPECT_NO_THROW(check_alpha(object.description.alpha, 2));
  EXPECT_THROW(check_alpha(object.description.alpha, 3), std::invalid_argument);
  object.description.alpha.mask[1] = 1;
  EXPECT_THROW(check_alpha(object.description.alpha, 2), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::snow
