// Compares the two engines step by step through their common interface.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <string>

#include "gpu/gl_context.h"
#include "gpu/gpu_thread.h"
#include "native/snow/bench.h"
#include "snow/scene/fragment_opacity.h"
#include "snow/step/cpu/engine.h"
#include "snow/step/frame_step.h"
#include "snow/step/gl/engine.h"

namespace snowbough::snow {
namespace {

/// A ball of 24 x 12 faces at a height over the ground, its map laid out by longitude and latitude.
SceneObject ball(const std::string& name, float radius, float z) {
  constexpr int32_t kAround = 24;
  constexpr int32_t kRings = 12;
  SceneObject object;
  object.description.name = name;
  MapTopology& topology = object.description.topology;
  topology.resolution = 128;
  const auto at = [](int32_t column, int32_t row) { return row * (kAround + 1) + column; };
  for (int32_t row = 0; row <= kRings; ++row) {
    const float polar = glm::pi<float>() * (static_cast<float>(row) / kRings);
    for (int32_t column = 0; column <= kAround; ++column) {
      const float turn = glm::two_pi<float>() * (static_cast<float>(column) / kAround);
      object.positions.emplace_back(radius * std::sin(polar) * std::cos(turn),
                                    radius * std::sin(polar) * std::sin(turn),
                                    z - radius * std::cos(polar));
    }
  }
  const auto add = [&](std::initializer_list<std::pair<int32_t, int32_t>> corners) {
    for (const auto& [column, row] : corners) {
      topology.triangles.push_back(at(column, row));
      topology.corner_uv.emplace_back(0.02f + 0.96f * static_cast<float>(column) / kAround,
                                      0.02f + 0.96f * static_cast<float>(row) / kRings);
    }
  };
  for (int32_t row = 0; row < kRings; ++row) {
    for (int32_t c = 0; c < kAround; ++c) {
      add({{c, row}, {c + 1, row}, {c + 1, row + 1}});
      add({{c, row}, {c + 1, row + 1}, {c, row + 1}});
    }
  }
  topology.vertex_count = static_cast<int32_t>(object.positions.size());
  object.bounds.include(glm::dvec3(-radius, -radius, z - radius));
  object.bounds.include(glm::dvec3(radius, radius, z + radius));
  object.table = std::make_shared<const TexelTable>(build_texel_table(topology));
  return object;
}

/// A card with a round hole, half a metre over the ground.
SceneObject card() {
  SceneObject object = square("card", 0.8f, 0.5f);
  for (glm::vec3& point : object.positions) point.x += 1.0f;
  object.bounds = {};
  for (const glm::vec3& point : object.positions) object.bounds.include(glm::dvec3(point));
  std::vector<uint8_t> image;
  for (int32_t i = 0; i < 32 * 32; ++i) {
    const glm::vec2 from_middle(static_cast<float>(i % 32) - 15.5f,
                                static_cast<float>(i / 32) - 15.5f);
    image.push_back(glm::dot(from_middle, from_middle) < 64.0f ? 0 : 255);
  }
  ObjectAlpha& alpha = object.description.alpha;
  alpha.corner_uv = object.description.topology.corner_uv;
  alpha.mask = {0, 0};
  alpha.masks = {std::make_shared<AlphaMask>(make_alpha_mask(32, 32, shared::kAlphaRepeat, image))};
  object.fragment_opacity =
      fragment_opacity(*object.table, object.description.topology, object.description.alpha);
  return object;
}

/// A leaf beside the ball that faces down, shaded smooth.
SceneObject leaf() {
  SceneObject object = square("leaf", 0.6f, 0.4f);
  std::vector<int32_t>& corners = object.description.topology.triangles;
  std::vector<glm::vec2>& uv = object.description.topology.corner_uv;
  for (const size_t triangle : {0, 1}) {
    std::swap(corners[3 * triangle + 1], corners[3 * triangle + 2]);
    std::swap(uv[3 * triangle + 1], uv[3 * triangle + 2]);
  }
  object.bounds = {};
  for (glm::vec3& point : object.positions) {
    point.x -= 1.2f;
    point.z += 0.4f * point.y * point.x;
    object.bounds.include(glm::dvec3(point));
  }
  object.table = std::make_shared<const TexelTable>(build_texel_table(object.description.topology));
  object.description.shading = corners;
  object.two_sided = {1, 1};
  return object;
}

struct Baked {
  std::vector<std::vector<float>> heights;
  std::vector<shared::ObjectSums> sums;
};

struct Weather {
  double pixel_size;
  double noise_density;
  double dt;
  int32_t tile_size;
};

/// Four steps of 1 cm from a fluttering wind on ground, ball, card and leaf.
Baked bake(Engine& engine, const Weather& weather) {
  std::vector<SceneObject> objects = objects_of(ball("ball", 0.5f, 0.9f), card());
  objects.push_back(square("ground", 4.0f, 0.0f, 256));
  objects.push_back(leaf());
  objects[0].description.shading = objects[0].description.topology.triangles;
  std::vector<const SceneObject*> all;
  std::vector<SceneObject*> moving;
  for (SceneObject& object : objects) {
    all.push_back(&object);
    moving.push_back(&object);
  }
  Baked baked;
  Movement movement;
  engine.run([&] {
    engine.build_scene(all);
    movement.lay_out(all);
    for (uint32_t number = 0; number < 4; ++number) {
      FrameStep step;
      step.fall = falling({0.4, 0.1, -1.0}, weather.pixel_size);
      step.fall.flutter = 0.05;
      step.fall.noise_density = weather.noise_density;
      step.fall.step_number = number;
      step.stability = {0.03f, 0.5f};
      step.dt = weather.dt;
      step.tile_size = weather.tile_size;
      run_step(engine, movement, moving, step);
    }
    for (size_t i = 0; i < objects.size(); ++i) {
      engine.read_height(i, baked.heights.emplace_back());
      baked.sums.push_back(engine.read_sums(i));
    }
  });
  return baked;
}

TEST(Engines, AgreeOnHeightsVolumesAndWhereSnowLies) {
  const bool in_software = gpu::GpuThread::shared()->run(gpu::renders_in_software);
  const auto gl = gl::make_engine(gpu::GpuThread::shared());
  const auto cpu = cpu::make_engine();
  for (const Weather& weather : {Weather{0.02, 1.0, 0.0, 2048}, Weather{0.007, 1.0, 0.5, 64},
                                 Weather{0.05, 0.4, 0.1, 2048}}) {
    SCOPED_TRACE("pixels of " + std::to_string(weather.pixel_size));
    const Baked a = bake(*gl, weather);
    const Baked b = bake(*cpu, weather);
    int64_t both = 0;
    int64_t either = 0;
    int64_t apart = 0;
    for (size_t object = 0; object < a.heights.size(); ++object) {
      ASSERT_EQ(a.heights[object].size(), b.heights[object].size());
      for (size_t i = 0; i < a.heights[object].size(); ++i) {
        const float one = a.heights[object][i];
        const float other = b.heights[object][i];
        both += one != 0.0f && other != 0.0f ? 1 : 0;
        either += one != 0.0f || other != 0.0f ? 1 : 0;
        // A ten-thousandth of a step's depth.
        apart += std::abs(one - other) > 1e-6f ? 1 : 0;
      }
      EXPECT_NEAR(a.sums[object].total_deposited, b.sums[object].total_deposited,
                  1e-5 * a.sums[object].total_deposited);
      EXPECT_NEAR(a.sums[object].held, b.sums[object].held, 1e-5 * a.sums[object].held);
      EXPECT_GT(a.sums[object].held, 0.0);
    }
    EXPECT_GE(static_cast<double>(both), 0.9999 * static_cast<double>(either));
    // At shadows' edges a pixel may go either way: 3.7e-4 of the texels on an NVIDIA H100.
    const double share = in_software ? 1e-4 : 6e-4;
    EXPECT_LE(static_cast<double>(apart), share * static_cast<double>(either));
  }
}

TEST(Engines, GiveTheSameBitsTwiceAndInTilesOfAnySize) {
  const auto engine = cpu::make_engine();
  const Baked whole = bake(*engine, {0.01, 1.0, 0.5, 2048});
  const Baked again = bake(*engine, {0.01, 1.0, 0.5, 2048});
  const Baked tiled = bake(*engine, {0.01, 1.0, 0.5, 64});
  EXPECT_EQ(whole.heights, again.heights);
  EXPECT_EQ(whole.heights, tiled.heights);
}

TEST(Engines, SnowOnTheBackOfALeafThatFacesDown) {
  const auto engine = cpu::make_engine();
  const std::vector<float> leaf = bake(*engine, {0.01, 1.0, 0.0, 2048}).heights[3];
  EXPECT_LT(leaf[32 * 64 + 32], -0.02f);
  EXPECT_LE(*std::max_element(leaf.begin(), leaf.end()), 0.0f);
}

TEST(Engines, LetSnowFallThroughAHoleOntoTheGround) {
  const auto engine = cpu::make_engine();
  const Baked baked = bake(*engine, {0.01, 1.0, 0.0, 2048});
  const std::vector<float>& card = baked.heights[1];
  EXPECT_EQ(card[32 * 64 + 32], 0.0f);  // the hole's middle
  EXPECT_NEAR(card[32 * 64 + 60], 0.04f, 1e-5f);
}

}  // namespace
}  // namespace snowbough::snow
