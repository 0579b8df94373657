// The deposit on the processor goes through runs of fragments and decides for many at once. These
// tests compare it with a plain version that evaluates each fragment and each sample alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "native/snow/bench.h"
#include "snow/scene/fragment_opacity.h"
#include "snow/step/cpu/kernel.h"
#include "snow/step/cpu/occlusion/occlusion.h"
#include "snow/step/cpu/passes.h"
#include "snow/step/cpu/run_visibility.h"
#include "snow/texels/texel_order.h"

namespace snowbough::snow {
namespace kernel {
namespace {

#define WITH_SHADING
struct PlainGain {
#include "shaders/lib/texel_gain.h"
};

}  // namespace
}  // namespace kernel

namespace {

/// A square field of `cells` x `cells` quads with bumps at random, and a card of two triangles over
/// it that leans on a side.
SceneObject bumps(int32_t cells, float height, uint32_t seed, int32_t resolution) {
  SceneObject object;
  object.description.name = "bumps";
  MapTopology& topology = object.description.topology;
  topology.resolution = resolution;
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  for (int32_t y = 0; y <= cells; ++y) {
    for (int32_t x = 0; x <= cells; ++x) {
      object.positions.emplace_back(static_cast<float>(x) / static_cast<float>(cells) - 0.5f,
                                    static_cast<float>(y) / static_cast<float>(cells) - 0.5f,
                                    height * unit(random));
    }
  }
  const auto add = [&](std::initializer_list<glm::ivec2> corners) {
    for (const glm::ivec2 corner : corners) {
      topology.triangles.push_back(corner.y * (cells + 1) + corner.x);
      topology.corner_uv.push_back(0.02f + 0.7f * glm::vec2(corner) / static_cast<float>(cells));
    }
  };
  for (int32_t y = 0; y < cells; ++y) {
    for (int32_t x = 0; x < cells; ++x) {
      add({{x, y}, {x + 1, y}, {x + 1, y + 1}});
      add({{x, y}, {x + 1, y + 1}, {x, y + 1}});
    }
  }
  const auto first = static_cast<int32_t>(object.positions.size());
  object.positions.insert(
      object.positions.end(),
      {{-0.2f, -0.3f, 0.15f}, {0.2f, -0.3f, 0.15f}, {0.2f, 0.1f, 0.5f}, {-0.2f, 0.1f, 0.5f}});
  for (const int32_t k : {0, 1, 2, 0, 2, 3}) {
    topology.triangles.push_back(first + k);
    topology.corner_uv.emplace_back(k == 1 || k == 2 ? 0.97f : 0.76f, k > 1 ? 0.4f : 0.03f);
  }
  topology.vertex_count = static_cast<int32_t>(object.positions.size());
  object.table = std::make_shared<const TexelTable>(build_texel_table(topology));
  for (const glm::vec3& point : object.positions) object.bounds.include(glm::dvec3(point));
  return object;
}

/// The state of a step before the deposit of its first tile.
struct Prepared {
  cpu::Scene scene;
  std::vector<Tile> tiles;
};

Prepared prepare(const SceneObject& object, const FallSettings& fall, int32_t tile_size) {
  Prepared made{cpu::build_scene({&object}), {}};
  made.scene.positions = object.positions;
  made.scene.frame = make_projection_frame(fall, object.bounds);
  cpu::set_up_triangles(made.scene.positions, made.scene.layout.triangles, made.scene.frame,
                        made.scene.corners, made.scene.surface);
  cpu::set_up_smooth_points(made.scene);
  cpu::choose_texels(made.scene);
  made.tiles = make_tiles({pixels_of(object.bounds, made.scene.frame)}, tile_size);
  return made;
}

void look(cpu::Scene& scene, const Tile& tile) {
  const PixelRect pixels = tile.with_margin();
  const auto count = static_cast<size_t>(pixels.size().x) * static_cast<size_t>(pixels.size().y);
  scene.seen.assign(count + cpu::kSeenSpare, {0, shared::kOpenSky});
  const std::vector<TriangleRange> ranges{{0, static_cast<int32_t>(scene.layout.triangles.size())}};
  cpu::OcclusionPass().run({scene.corners, ranges, {}}, pixels, std::span(scene.seen).first(count));
}

kernel::PlainGain plain_of(const cpu::Scene& scene, const Tile& tile) {
  kernel::PlainGain plain{};
  plain.projection = scene.frame;
  plain.triangle_corners = scene.corners.data();
  plain.triangle_surface = scene.surface.data();
  if (scene.layout.smooth_points.count() > 0) {
    plain.triangle_points = scene.layout.smooth_points.of_triangle.data();
    plain.smooth_points = scene.smooth_points.data();
  }
  plain.triangle_sheets = kernel::words(scene.layout.triangle_sheets);
  plain.map_triangles = kernel::rows<glm::vec4>(scene.layout.map_triangles);
  plain.occlusion = kernel::rows<glm::uvec2>(scene.seen);
  plain.tile_origin = tile.with_margin().low;
  plain.tile_size = tile.with_margin().size();
  plain.resolution = static_cast<float>(scene.receivers[0].resolution);
  return plain;
}

/// A texel's fragments of the table.
struct TexelFragments {
  size_t begin;
  size_t end;
};

TexelFragments fragments_of(const TexelTable& table, int32_t i) {
  return {static_cast<size_t>(table.fragment_begin[static_cast<size_t>(i)]),
          static_cast<size_t>(table.fragment_begin[static_cast<size_t>(i) + 1])};
}

/// Adds what a texel gains in a tile to `step`, fragment by fragment.
void add_by_fragments(kernel::PlainGain& plain, const SceneObject& object, TexelFragments own,
                      bool adds_to_gain, shared::TexelStep& step) {
  const TexelTable& table = *object.table;
  kernel::PlainGain::FragmentSums sums{};
  bool positive = false;
  bool back = false;
  for (size_t f = own.begin; f < own.end; ++f) {
    const auto triangle = static_cast<uint32_t>(table.fragment_triangle[f]);
    const glm::vec4 surface = plain.triangle_surface[triangle];
    const glm::vec2 w = table.fragment_barycentric[f];
    float up = surface.z;
    if (plain.is_smooth(triangle)) {
      const auto points = plain.smooth_triangle(triangle);
      up = plain.between(points.corner.z, points.edge_b.z, points.edge_c.z, w.x, w.y);
    }
    sums = plain.with_fragment(sums, table.fragment_share[f] * surface.y, up, surface.w != 0.0f);
    positive = positive || (surface.x > 0.0f && surface.w >= 0.0f);
    back = back || (surface.x > 0.0f && surface.w < 0.0f);
  }
  const auto texel = plain.surface_of_sums(sums);
  const bool mixed = positive && back;
  uint32_t gain = adds_to_gain ? step.gain & ~(shared::kBackSide | shared::kMixedSides) : 0u;
  for (size_t f = own.begin; f < own.end; ++f) {
    const auto triangle = static_cast<uint32_t>(table.fragment_triangle[f]);
    const glm::vec4 surface = plain.triangle_surface[triangle];
    const glm::vec2 w = table.fragment_barycentric[f];
    const float there = object.fragment_opacity.empty() ? 1.0f : object.fragment_opacity[f];
    const float area = table.fragment_share[f] * surface.y * there;
    if (!(surface.x > 0.0f && area > 0.0f)) continue;
    float falls = surface.x;
    if (plain.is_smooth(triangle)) {
      const auto points = plain.smooth_triangle(triangle);
      falls = plain.smooth_facing(
          plain.between(points.corner.x, points.edge_b.x, points.edge_c.x, w.x, w.y),
          plain.between(points.corner.y, points.edge_b.y, points.edge_c.y, w.x, w.y), surface);
    }
    const auto triangle_on_map =
        plain.gain_triangle(static_cast<int>(triangle), static_cast<int>(triangle));
    const float most = falls * (area / texel.area) * plain.gain_units(mixed);
    gain += plain.fragment_gain(triangle, table.fragment_share[f], w, triangle_on_map, most)
            << plain.gain_shift(mixed, surface.w < 0.0f);
  }
  step = {gain | plain.gain_sides(mixed, back), texel.area, texel.up, texel.back_up};
}

shared::TexelStep step_of(const cpu::Receiver& receiver, size_t i) {
  const cpu::TexelSteps& steps = receiver.steps;
  return {steps.gain[i], steps.area[i], steps.up[i], steps.back_up[i]};
}

/// Compares all tiles of a step with the plain version; returns how many texels gained anything.
size_t compare(const SceneObject& object, const FallSettings& fall, int32_t tile_size) {
  Prepared step = prepare(object, fall, tile_size);
  const cpu::Receiver& receiver = step.scene.receivers[0];
  const std::vector<int32_t> order = texel_order(*object.table);
  std::vector<shared::TexelStep> expected(order.size());
  for (const Tile& tile : step.tiles) {
    const bool is_first = &tile == &step.tiles.front();
    look(step.scene, tile);
    cpu::gather_deposit(step.scene, tile, is_first);
    kernel::PlainGain plain = plain_of(step.scene, tile);
    for (size_t i = 0; i < order.size(); ++i) {
      add_by_fragments(plain, object, fragments_of(*object.table, order[i]), !is_first,
                       expected[i]);
    }
  }
  size_t gained = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    const shared::TexelStep own = step_of(receiver, i);
    EXPECT_EQ(own.gain, expected[i].gain) << "texel " << i;
    EXPECT_EQ(own.area, expected[i].area) << "texel " << i;
    EXPECT_EQ(own.up, expected[i].up) << "texel " << i;
    EXPECT_EQ(own.back_up, expected[i].back_up) << "texel " << i;
    if (testing::Test::HasFailure()) return 0;
    gained += own.gain != 0;
  }
  return gained;
}

TEST(CpuDeposit, IsTheSameBitsAsFragmentByFragment) {
  for (uint32_t seed = 0; seed < 4; ++seed) {
    const SceneObject object = bumps(seed % 2 == 0 ? 6 : 40, 0.03f, seed, 128);
    for (const double pixel_size : {0.001, 0.004, 0.01, 0.05}) {
      for (const glm::dvec3 direction :
           {glm::dvec3(0, 0, -1), glm::dvec3(0.5, 0.3, -1), glm::dvec3(3, -1, -0.1)}) {
        SCOPED_TRACE("seed " + std::to_string(seed) + ", pixels of " + std::to_string(pixel_size));
        EXPECT_GT(compare(object, falling(direction, pixel_size), 2048), 100u);
      }
    }
  }
}

TEST(CpuDeposit, IsTheSameBitsHoweverTheTilesAreCut) {
  const SceneObject object = bumps(12, 0.05f, 7, 128);
  EXPECT_GT(compare(object, falling({0.2, 0.3, -1.0}, 0.004), 64), 1000u);
}

TEST(CpuDeposit, IsTheSameBitsUnderNoise) {
  FallSettings fall = falling({0.2, 0.3, -1.0}, 0.004);
  fall.noise_density = 0.3;
  EXPECT_GT(compare(bumps(12, 0.05f, 8, 128), fall, 2048), 1000u);
}

TEST(CpuDeposit, IsTheSameBitsOnSmoothAndTwoSidedSurfacesWithHoles) {
  SceneObject object = bumps(24, 0.08f, 9, 128);
  const auto triangles = static_cast<size_t>(object.triangle_count());
  object.description.shading = object.description.topology.triangles;
  // The card stays flat.
  std::fill(object.description.shading.end() - 6, object.description.shading.end(), -1);
  object.two_sided.assign(triangles, 1);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (size_t f = 0; f < object.table->fragment_triangle.size(); ++f) {
    object.fragment_opacity.push_back(f % 7 == 0 ? 0.0f : unit(random));
  }
  // From below and from the side: positive sides, backs and texels with both.
  for (const glm::dvec3 direction : {glm::dvec3(0.1, 0.2, -1), glm::dvec3(5, 1, -0.2)}) {
    SCOPED_TRACE(direction.x);
    EXPECT_GT(compare(object, falling(direction, 0.005), 2048), 500u);
  }
}

TEST(CpuDeposit, RecomputesAreasWhereTheSurfaceHasMoved) {
  const SceneObject object = bumps(6, 0.03f, 1, 64);
  Prepared step = prepare(object, falling({0, 0, -1}, 0.01), 2048);
  look(step.scene, step.tiles[0]);
  cpu::gather_deposit(step.scene, step.tiles[0], true);
  cpu::Receiver& receiver = step.scene.receivers[0];
  const float before = receiver.steps.area[0];
  for (glm::vec3& point : step.scene.positions) point *= 2.0f;
  cpu::set_up_triangles(step.scene.positions, step.scene.layout.triangles, step.scene.frame,
                        step.scene.corners, step.scene.surface);
  cpu::evaluate_texels(step.scene);
  EXPECT_EQ(receiver.steps.area[0], before) << "of the same pose";
  EXPECT_EQ(receiver.steps.gain[0], 0u);
  ++receiver.pose;
  cpu::evaluate_texels(step.scene);
  EXPECT_FLOAT_EQ(receiver.steps.area[0], 4.0f * before);
}

}  // namespace
}  // namespace snowbough::snow
