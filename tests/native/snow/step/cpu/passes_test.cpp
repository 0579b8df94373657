// The passes of a snow step on the processor, one by one.
#include "snow/step/cpu/passes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "native/snow/bench.h"
#include "snow/step/cpu/occlusion/occlusion.h"
#include "snow/step/cpu/run_visibility.h"

namespace snowbough::snow {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::FloatNear;

/// A scene of one object whose triangles are set up.
cpu::Scene scene_of(const SceneObject& object, const FallSettings& fall) {
  cpu::Scene scene = cpu::build_scene({&object});
  scene.positions = object.positions;
  scene.frame = make_projection_frame(fall, object.bounds);
  cpu::set_up_triangles(scene.positions, scene.layout.triangles, scene.frame, scene.corners,
                        scene.surface);
  return scene;
}

/// The same object, seen from behind.
SceneObject turned_over(SceneObject object) {
  std::vector<int32_t>& corners = object.description.topology.triangles;
  for (size_t t = 0; t < corners.size(); t += 3) std::swap(corners[t + 1], corners[t + 2]);
  return object;
}

float stable_height(float height, float deposit, float dt, float max_depth, bool is_ceiling) {
  const SceneObject floor = square("a", 1.0f, 0.0f);
  const SceneObject object = is_ceiling ? turned_over(floor) : floor;
  cpu::Scene scene = scene_of(object, falling({0, 0, -1}, 0.1));
  cpu::Receiver& receiver = scene.receivers[0];
  std::fill(receiver.height.begin(), receiver.height.end(), height);
  receiver.active = {0, 1, 2, 3};
  cpu::evaluate_texels(scene);
  std::fill(receiver.steps.gain.begin(), receiver.steps.gain.end(), 1u << 28);
  cpu::apply_stability(scene, {max_depth, 2.0f}, deposit, dt);
  return receiver.height[1000];
}

TEST(CpuStability, FollowsTheClosedFormBelowAcrossAndAboveCapacity) {
  expect_closed_form(stable_height);
}

TEST(CpuStability, AddsUpVolumesAndWhatTheSkySees) {
  const SceneObject object = square("a", 2.0f, 0.0f);
  cpu::Scene scene = scene_of(object, falling({0, 0, -1}, 0.1));
  cpu::Receiver& receiver = scene.receivers[0];
  std::fill(receiver.height.begin(), receiver.height.end(), 0.1f);
  receiver.active = {0, 1, 2, 3};
  cpu::evaluate_texels(scene);
  std::fill(receiver.steps.gain.begin(), receiver.steps.gain.end(),
            static_cast<uint32_t>(shared::kGainUnits));
  cpu::apply_stability(scene, {1.0f, 2.0f}, 0.02f, 1.0f);
  EXPECT_NEAR(receiver.sums.deposited, 0.02 * 4.0, 1e-6);
  EXPECT_NEAR(receiver.sums.held, 0.12 * 4.0, 1e-6);
  EXPECT_NEAR(receiver.sums.visible_area, 4.0, 1e-5);
  EXPECT_EQ(receiver.sums.slid, 0.0);
}

TEST(CpuTexelSurface, HoldsAreaAndUpwardPart) {
  SceneObject object = square("a", 1.0f, 0.0f);
  for (glm::vec3& point : object.positions) point.z = 0.75f * point.x;
  cpu::Scene scene = scene_of(object, falling({0, 0, -1}, 0.1));
  scene.receivers[0].active = {0, 1, 2, 3};
  cpu::evaluate_texels(scene);
  const cpu::TexelSteps& steps = scene.receivers[0].steps;
  EXPECT_THAT(steps.area, Each(FloatNear(1.25f / 4096.0f, 1e-7f)));
  EXPECT_THAT(steps.up, Each(FloatNear(0.8f, 1e-5f)));
  EXPECT_THAT(steps.back_up, Each(0.0f));
  EXPECT_THAT(steps.gain, Each(0u));
}

TEST(CpuTexelSurface, StaysAsItIsUntilThePoseChanges) {
  const SceneObject object = square("a", 1.0f, 0.0f);
  cpu::Scene scene = scene_of(object, falling({0, 0, -1}, 0.1));
  cpu::Receiver& receiver = scene.receivers[0];
  receiver.active = {0, 1, 2, 3};
  cpu::evaluate_texels(scene);
  std::fill(receiver.steps.area.begin(), receiver.steps.area.end(), 7.0f);
  cpu::evaluate_texels(scene);
  EXPECT_EQ(receiver.steps.area[5], 7.0f);
  ++receiver.pose;
  cpu::evaluate_texels(scene);
  EXPECT_NEAR(receiver.steps.area[5], 1.0f / 4096.0f, 1e-7f);
}

TEST(CpuTexels, AreChosenWhereTheyFaceTheFallOrSnowLies) {
  const SceneObject object = plate();
  cpu::Scene scene = scene_of(object, falling({0, 0, -1}, 0.1));
  cpu::Receiver& receiver = scene.receivers[0];
  ASSERT_EQ(receiver.group_count(), 4u);
  std::fill(receiver.holds_snow.begin(), receiver.holds_snow.end(), uint8_t{0});
  cpu::choose_texels(scene);
  EXPECT_THAT(receiver.active, ElementsAre(0, 1));
  receiver.height[10 * 64 + 40] = 0.1f;  // on the side that looks down, in the map's lower half
  cpu::find_snow(receiver);
  EXPECT_THAT(receiver.holds_snow, ElementsAre(0, 0, 1, 0));
  cpu::choose_texels(scene);
  EXPECT_THAT(receiver.active, ElementsAre(0, 1, 2));
}

/// Pixels in which the sky sees the object's back.
uint32_t back_pixels(const SceneObject& object) {
  cpu::Scene scene = scene_of(object, falling({0, 0, -1}, 0.1));
  scene.back_pixels.assign(1, 0);
  const Tile tile = make_tiles({pixels_of(object.bounds, scene.frame)}, 2048)[0];
  const PixelRect pixels = tile.with_margin();
  const auto count = static_cast<size_t>(pixels.size().x) * static_cast<size_t>(pixels.size().y);
  scene.seen.assign(count + cpu::kSeenSpare, {0, shared::kOpenSky});
  const std::vector<TriangleRange> ranges{{0, object.triangle_count()}};
  cpu::OcclusionPass().run({scene.corners, ranges, {}}, pixels, std::span(scene.seen).first(count));
  cpu::count_back_faces(scene, tile);
  return scene.back_pixels[0];
}

TEST(CpuBackFaces, AreCountedPixelByPixelWhereAReceiverTurnsItsBack) {
  SceneObject object = square("a", 1.0f, 0.0f);
  EXPECT_EQ(back_pixels(object), 0u);
  object = turned_over(std::move(object));
  EXPECT_EQ(back_pixels(object), 100u);
  object.description.receive = false;
  EXPECT_EQ(back_pixels(object), 0u);
}

}  // namespace
}  // namespace snowbough::snow
