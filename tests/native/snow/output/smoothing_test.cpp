#include "snow/output/smoothing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <glm/geometric.hpp>
#include <memory>
#include <random>
#include <thread>

#include "gpu/gpu_thread.h"
#include "native/snow/layouts.h"
#include "native/snow/reference.h"
#include "snow/output/cpu_filter.h"
#include "snow/output/dilate.h"
#include "snow/output/gl/weighted_rows.h"

namespace snowbough::snow {
namespace {

struct Map {
  LaidOutMesh mesh;
  TexelTable table;
  SeamTable seams;
};

Map make_map(LaidOutMesh mesh) {
  Map map{std::move(mesh), {}, {}};
  map.table = build_texel_table(map.mesh.topology);
  map.seams = build_seam_table(map.mesh.topology, map.table, map.mesh.positions);
  return map;
}

/// Adds a rectangle in the plane z = 0 with vertices of its own: `low` to `high` on the map,
/// `size_x` by `size_y` metres in space at x = `left`.
void add_plate(LaidOutMesh& mesh, glm::vec2 low, glm::vec2 high, float left, float size_x,
               float size_y) {
  const int32_t v = mesh.topology.vertex_count;
  mesh.topology.vertex_count += 4;
  for (const glm::vec2 c : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
    mesh.positions.emplace_back(left + c.x * size_x, c.y * size_y, 0.0f);
  }
  for (const int k : {0, 1, 2, 0, 2, 3}) mesh.topology.triangles.push_back(v + k);
  for (const glm::vec2 c : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 0),
                            glm::vec2(1, 1), glm::vec2(0, 1)}) {
    mesh.topology.corner_uv.push_back(low + c * (high - low));
  }
}

/// One plate over the whole map, `size_x` by `size_y` metres.
Map plate(int32_t resolution, float size_x, float size_y) {
  LaidOutMesh mesh;
  mesh.topology.resolution = resolution;
  add_plate(mesh, glm::vec2(0), glm::vec2(1), 0, size_x, size_y);
  return make_map(std::move(mesh));
}

std::vector<float> blanket(const Map& map, float height) {
  std::vector<float> values(static_cast<size_t>(map.table.resolution) * map.table.resolution, 0.0f);
  for (const int32_t texel : map.table.texel) values[texel] = height;
  return values;
}

std::vector<float> smooth(const Map& map, float radius, std::vector<float> heights,
                          int32_t threads = 2) {
  const SmoothingGrid grid = build_smoothing_grid(map.table, map.seams);
  Smoother(grid, {radius}, threads).run(heights);
  return heights;
}

double volume(const Map& map, const std::vector<float>& heights) {
  double sum = 0.0;
  for (size_t i = 0; i < map.table.texel.size(); ++i) {
    sum += double{map.seams.texel_area[i]} * heights[map.table.texel[i]];
  }
  return sum;
}

/// Standard deviation in metres along x and y of what a little more snow in the middle of a blanket
/// of the given depth is spread to.
glm::dvec2 spread_of(const Map& map, float radius, float depth) {
  const int32_t size = map.table.resolution;
  std::vector<float> heights = blanket(map, depth);
  const int32_t middle = size / 2;
  heights[static_cast<size_t>(middle) * size + middle] *= 1.5f;
  const std::vector<float> smoothed = smooth(map, radius, heights);
  glm::dvec2 variance(0.0);
  double sum = 0.0;
  for (int32_t y = 0; y < size; ++y) {
    for (int32_t x = 0; x < size; ++x) {
      const double h = double{smoothed[static_cast<size_t>(y) * size + x]} - double{depth};
      const glm::dvec2 d = glm::dvec2(x - middle, y - middle) * glm::dvec2(map.seams.texel_size[0]);
      variance += h * d * d;
      sum += h;
    }
  }
  EXPECT_NEAR(sum, 0.5 * depth, 1e-3 * depth);
  return glm::sqrt(variance / sum);
}

TEST(Smoothing, theRadiusIsInMetres) {
  for (const float texels : {0.5f, 1.0f, 2.0f, 3.0f, 6.0f, 10.0f}) {
    const Map map = plate(128, 12.8f, 12.8f);
    const glm::dvec2 spread = spread_of(map, texels * 0.1f, 0.01f);
    EXPECT_NEAR(spread.x, texels * 0.1, 0.004 * texels);
    EXPECT_NEAR(spread.y, texels * 0.1, 0.004 * texels);
  }
}

TEST(Smoothing, theRadiusGrowsToAThirdOfTheDepth) {
  const Map map = plate(128, 12.8f, 12.8f);
  for (const float depth : {0.6f, 1.5f, 3.0f}) {
    const glm::dvec2 spread = spread_of(map, 0.1f, depth);
    EXPECT_NEAR(spread.x, depth / 3.0, 0.02 * depth);
    EXPECT_NEAR(spread.y, depth / 3.0, 0.02 * depth);
  }
}

TEST(Smoothing, aStretchedLayoutIsSmoothedEvenlyOnTheSurface) {
  const Map map = plate(128, 12.8f, 25.6f);
  const glm::dvec2 spread = spread_of(map, 0.3f, 0.01f);
  EXPECT_NEAR(spread.x, 0.3, 0.03);
  EXPECT_NEAR(spread.y, 0.3, 0.03);
}

TEST(Smoothing, aLevelBlanketStaysLevelUpToItsRim) {
  LaidOutMesh mesh;
  mesh.topology.resolution = 64;
  add_plate(mesh, glm::vec2(0.1f), glm::vec2(0.77f), 0, 1, 1);
  const Map map = make_map(std::move(mesh));
  const auto heights = blanket(map, 0.25f);
  EXPECT_THAT(smooth(map, 0.1f, heights), testing::Pointwise(testing::FloatNear(1e-6f), heights));
}

TEST(Smoothing, nothingLeaksToAChartBesideThatIsNoNeighbourOnTheSurface) {
  LaidOutMesh mesh;
  mesh.topology.resolution = 64;
  add_plate(mesh, glm::vec2(0, 0), glm::vec2(0.5f, 1), 0, 1, 1);
  add_plate(mesh, glm::vec2(0.5f, 0), glm::vec2(1, 1), 5, 1, 1);
  const Map map = make_map(std::move(mesh));
  std::vector<float> heights = blanket(map, 1.0f);
  for (size_t i = 0; i < map.table.texel.size(); ++i) {
    if (map.table.chart[i] == 1) heights[map.table.texel[i]] = 0.5f;
  }
  EXPECT_THAT(smooth(map, 0.2f, heights), testing::Pointwise(testing::FloatNear(1e-6f), heights));
}

TEST(Smoothing, aRadiusOfZeroPassesTheMapOn) {
  const Map map = plate(64, 1, 1);
  std::vector<float> heights(64 * 64);
  for (size_t i = 0; i < heights.size(); ++i) heights[i] = static_cast<float>(i % 7);
  EXPECT_EQ(smooth(map, 0.0f, heights), heights);
}

TEST(Smoothing, aNegativeRadiusIsRefused) {
  EXPECT_THROW(check_smoothing({-1.0f}), std::invalid_argument);
  EXPECT_THROW(check_smoothing({std::nanf("")}), std::invalid_argument);
}

/// Deep snow with patches of bare ground, uneven throughout.
std::vector<float> patchy_snow(const Map& map, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> heights = blanket(map, 0.0f);
  const int32_t size = map.table.resolution;
  for (const int32_t texel : map.table.texel) {
    const bool bare = (texel % size / 16 + texel / size / 16) % 3 == 0;
    if (!bare) heights[texel] = 0.05f + 1e-4f * static_cast<float>(random() % 2000);
  }
  return heights;
}

TEST(Smoothing, keepsTheVolumeAndLiftsNoBareGroundAcrossSeams) {
  LaidOutMesh apart = cylinder(24, 8, 0.5f, 2.0f, 256);
  lay_out_apart(apart, 256);
  for (LaidOutMesh& mesh : std::array{cylinder(24, 8, 0.5f, 2.0f, 256), apart}) {
    const Map map = make_map(std::move(mesh));
    const auto heights = patchy_snow(map, 3);
    for (const float radius : {0.001f, 0.02f, 0.2f}) {
      const auto smoothed = smooth(map, radius, heights);
      EXPECT_NEAR(volume(map, smoothed) / volume(map, heights), 1.0, 2e-6) << "radius " << radius;
      for (size_t i = 0; i < heights.size(); ++i) {
        ASSERT_EQ(smoothed[i] > 0.0f, heights[i] > 0.0f) << "texel " << i;
      }
    }
  }
}

TEST(Smoothing, doesNotRing) {
  // A step of 20 cm on deep snow: nothing may lie above or below what lay there.
  const Map map = plate(128, 1.28f, 1.28f);
  std::vector<float> heights(128 * 128);
  for (size_t i = 0; i < heights.size(); ++i) heights[i] = i % 128 < 64 ? 0.5f : 0.3f;
  const auto smoothed = smooth(map, 0.02f, heights);
  float before = 1.0f;
  for (size_t x = 0; x < 128; ++x) {
    const float h = smoothed[64 * 128 + x];
    EXPECT_LE(h, before + 1e-6f) << "column " << x;
    EXPECT_GE(h, 0.3f - 1e-6f);
    EXPECT_LE(h, 0.5f + 1e-6f);
    before = h;
  }
  // Round, too: the steepest place is no terrace of the coarse levels.
  for (size_t x = 1; x < 127; ++x) {
    const float* const at = &smoothed[64 * 128 + x];
    EXPECT_LT(std::abs(at[1] - 2 * at[0] + at[-1]), 1.5e-3f) << "column " << x;
  }
}

TEST(Smoothing, snowThatEndsInACliffEndsRounded) {
  const Map map = plate(128, 1.28f, 1.28f);
  std::vector<float> heights(128 * 128);
  for (size_t i = 0; i < heights.size(); ++i) heights[i] = i % 128 < 64 ? 0.15f : 0.0f;
  const auto smoothed = smooth(map, 0.02f, heights);
  const float* const row = &smoothed[64 * 128];
  EXPECT_LT(row[63], 0.05f);      // under a third at the rim
  EXPECT_GT(row[63 - 5], 0.14f);  // and full again a third of the depth further in
  EXPECT_LT(*std::max_element(row, row + 64), 0.185f);
  EXPECT_EQ(row[64], 0.0f);
}

TEST(Smoothing, snowThatTapersOffGoesOnTaperingOff) {
  const Map map = plate(128, 1.28f, 1.28f);
  std::vector<float> heights(128 * 128, 0.0f);
  for (size_t i = 0; i < heights.size(); ++i) {
    heights[i] = std::clamp(0.01f * (static_cast<float>(i % 128) - 31.5f), 0.0f, 0.3f);
  }
  const auto smoothed = smooth(map, 0.02f, heights);
  for (size_t x = 32; x < 50; ++x) {
    const float height = heights[64 * 128 + x];
    EXPECT_NEAR(smoothed[64 * 128 + x], height, 0.15f * height + 0.006f) << "column " << x;
  }
}

TEST(Smoothing, dustBesideDeepSnowStaysDust) {
  const Map map = plate(128, 1.28f, 1.28f);
  std::vector<float> heights(128 * 128);
  for (size_t i = 0; i < heights.size(); ++i) heights[i] = i % 128 < 63 ? 0.2f : 1e-4f;
  const auto smoothed = smooth(map, 0.02f, heights);
  for (size_t x = 63; x < 128; ++x) EXPECT_NEAR(smoothed[64 * 128 + x], 1e-4f, 1e-8f);
  EXPECT_LT(smoothed[64 * 128 + 62], 0.07f);
}

TEST(Smoothing, theBackIsSmoothedLikeTheFrontAndNotWithIt) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 256));
  std::vector<float> heights = patchy_snow(map, 4);
  const auto front = smooth(map, 0.03f, heights);
  for (float& h : heights) h = -h;
  auto back = smooth(map, 0.03f, heights);
  for (float& h : back) h = -h;
  EXPECT_EQ(back, front);
  // Front and back side by side.
  const Map square = plate(128, 1.28f, 1.28f);
  std::vector<float> both(128 * 128);
  for (size_t i = 0; i < both.size(); ++i) both[i] = i % 128 < 63 ? 0.1f : -0.1f;
  const auto smoothed = smooth(square, 0.05f, both);
  double sum = 0.0;
  for (size_t i = 0; i < both.size(); ++i) {
    ASSERT_GT(smoothed[i] * both[i], 0.0f);
    if (both[i] > 0.0f) sum += smoothed[i];
  }
  EXPECT_NEAR(sum, 0.1 * 63 * 128, 1e-2);
}

TEST(Smoothing, aSeamIsNoBorder) {
  // The same ridge of snow along the tube, on the seam and far away from it.
  const Map map = make_map(cylinder(48, 16, 0.5f, 2.0f, 320));
  const auto column_angle = [](int32_t column) {
    return 6.2831853f * ((static_cast<float>(column) + 0.5f) / 320.0f - 0.1f) / 0.8f;
  };
  const auto profile = [&](float centre) {
    std::vector<float> heights = blanket(map, 0.0f);
    for (const int32_t texel : map.table.texel) {
      const float off = std::remainder(column_angle(texel % 320) - centre, 6.2831853f);
      heights[texel] = 0.05f + (std::abs(off) < 0.2f ? 0.15f : 0.0f);
    }
    const auto smoothed = smooth(map, 0.02f, heights);
    std::vector<float> around;
    for (float off = -0.6f; off < 0.6f; off += 0.05f) {
      const float angle = centre + off < 0.0f ? centre + off + 6.2831853f : centre + off;
      const float at = (angle / 6.2831853f * 0.8f + 0.1f) * 320.0f - 0.5f;
      // Between the two columns, where both are the tube's.
      const auto left = std::clamp(static_cast<int32_t>(std::floor(at)), 32, 286);
      const float part = std::clamp(at - static_cast<float>(left), 0.0f, 1.0f);
      around.push_back((1 - part) * smoothed[160 * 320 + left] +
                       part * smoothed[160 * 320 + left + 1]);
    }
    return around;
  };
  const auto away = profile(3.1415927f);
  const auto seam = profile(0.0f);
  for (size_t k = 0; k < away.size(); ++k) EXPECT_NEAR(seam[k], away[k], 4e-3f) << k;
}

/// One value an owned texel, put on the map and continued, where its tiles are said to be `filled`.
std::vector<float> continued(const Map& map, const std::vector<float>& values, bool filled = true) {
  const auto resolution = static_cast<size_t>(map.table.resolution);
  std::vector<float> shown(resolution * resolution, 0.0f);
  for (size_t i = 0; i < values.size(); ++i) shown[map.table.texel[i]] = values[i];
  const size_t tiles = static_cast<size_t>(MapTiles(map.table.resolution).count());
  MapContinuation(map.table, map.seams).run(shown, std::vector<uint8_t>(tiles, filled));
  return shown;
}

TEST(MapContinuation, continuesTheMapByFourTexels) {
  LaidOutMesh mesh;
  mesh.topology.resolution = 64;
  add_plate(mesh, glm::vec2(0.25f), glm::vec2(0.5f), 0, 1, 1);
  const Map map = make_map(std::move(mesh));
  const auto shown = continued(map, std::vector<float>(map.table.texel.size(), 2.0f));
  const auto at = [&](int x, int y) { return shown[static_cast<size_t>(y) * 64 + x]; };
  EXPECT_EQ(at(16, 20), 2.0f);
  EXPECT_EQ(at(12, 20), 2.0f);
  EXPECT_EQ(at(11, 20), 0.0f);
  EXPECT_EQ(at(35, 35), 2.0f);
  EXPECT_EQ(at(36, 20), 0.0f);
}

TEST(MapContinuation, showsTheOtherSideOfASeamBeyondIt) {
  // A strip of 2 x 1 metres, bent nowhere, cut in the middle; the right half lies elsewhere on the
  // map.
  LaidOutMesh mesh;
  mesh.topology.resolution = 64;
  mesh.topology.vertex_count = 6;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}};
  mesh.topology.triangles = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
  const auto uv = [](float x, float y) { return glm::vec2(x, y) / 64.0f; };
  mesh.topology.corner_uv = {uv(8, 8),  uv(24, 8), uv(24, 24), uv(8, 8),  uv(24, 24), uv(8, 24),
                             uv(40, 8), uv(56, 8), uv(56, 24), uv(40, 8), uv(56, 24), uv(40, 24)};
  const Map map = make_map(std::move(mesh));
  std::vector<float> height(map.table.texel.size());
  for (size_t i = 0; i < height.size(); ++i) {
    const int32_t x = map.table.texel[i] % 64;
    height[i] = static_cast<float>(x < 32 ? x - 8 : x - 24);
  }
  const auto shown = continued(map, height);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(shown[16 * 64 + 24 + k], 16.0f + static_cast<float>(k), 1e-4f);
    EXPECT_NEAR(shown[16 * 64 + 39 - k], 15.0f - static_cast<float>(k), 1e-4f);
  }
}

TEST(MapContinuation, passesOverWhatIsSaidToBeBare) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 256));
  const std::vector<float> values(map.table.texel.size(), 2.0f);
  const auto shown = continued(map, values, false);
  EXPECT_EQ(std::count(shown.begin(), shown.end(), 2.0f), map.table.texel.size());
}

TEST(MapContinuation, agreesWithPlainSumsOverManyTiles) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 256));
  std::vector<float> values(map.table.texel.size());
  std::mt19937 random(11);
  for (float& value : values) value = static_cast<float>(random() % 1000);
  EXPECT_EQ(continued(map, values), dilated(map.table, map.seams, values));
}

std::vector<float> random_map(const Map& map, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> stored(static_cast<size_t>(map.table.resolution) * map.table.resolution, 0.0f);
  for (const int32_t texel : map.table.texel)
    stored[texel] = 0.03f + static_cast<float>(random() % 1000) * 1e-4f;
  return stored;
}

TEST(WeightedRowsPass, writesSumsAndWhatHasNoTerms) {
  gpu::GpuThread::shared()->run([] {
    RowBuffers rows;
    rows.count = 3;
    rows.begin = gpu::Buffer(std::vector<int32_t>{0, 2, 2, 3});
    rows.source = gpu::Buffer(std::vector<int32_t>{0, 2, 1});
    rows.weight = gpu::Buffer(std::vector<float>{0.5f, 2.0f, 3.0f});
    rows.target = gpu::Buffer(std::vector<int32_t>{4, 5, 3});
    const gpu::Buffer values(std::vector<float>{1.0f, 10.0f, 100.0f, 7.0f, 7.0f, 7.0f});
    WeightedRowsPass pass;
    pass.run(rows, values, values, true);
    EXPECT_THAT(values.read_all<float>(),
                testing::ElementsAre(1.0f, 10.0f, 100.0f, 30.0f, 200.5f, kNothing));
    pass.run(rows, values, values, false);
    EXPECT_EQ(values.read_all<float>().back(), 0.0f);
  });
}

LaidOutMesh bunny() {
  LaidOutMesh mesh = read_obj_mesh(std::string(SNOWBOUGH_SHARED_DATA) + "/snow/stanford-bunny.obj");
  if (!mesh.positions.empty()) lay_out_by_direction(mesh, 1024, 4.0f);
  return mesh;
}

TEST(CpuFilter, doesNotDependOnTheNumberOfThreads) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 256));
  const auto stored = random_map(map, 5);
  const auto one = CpuFilter(map.table, map.seams, {0.03f}, 1).run(stored).height;
  EXPECT_EQ(CpuFilter(map.table, map.seams, {0.03f}, 3).run(stored).height, one);
}

TEST(CpuFilter, mapsMadeAtOnceAreWhatTheyAreAlone) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 256));
  CpuFilter output(map.table, map.seams, {0.03f});
  std::vector<std::vector<float>> stored;
  std::vector<std::vector<float>> expected;
  for (const uint32_t seed : {1, 2, 3, 4}) {
    stored.push_back(random_map(map, seed));
    expected.push_back(output.run(stored.back()).height);
  }
  std::vector<std::vector<float>> made(stored.size());
  {
    std::vector<std::jthread> threads;
    for (size_t i = 0; i < stored.size(); ++i) {
      threads.emplace_back([&, i] { made[i] = output.run(stored[i]).height; });
    }
  }
  EXPECT_EQ(made, expected);
}

/// The map with snow on a few texels only.
std::vector<float> patch_of(const Map& map, size_t first, size_t count) {
  std::vector<float> stored(random_map(map, 9).size(), 0.0f);
  for (size_t i = first; i < first + count; ++i) stored[map.table.texel[i]] = 0.1f;
  return stored;
}

TEST(CpuFilter, nothingStaysWhereSnowIsGone) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 512));
  CpuFilter output(map.table, map.seams, {0.06f});
  output.run(random_map(map, 5));
  const auto patch = patch_of(map, map.table.texel.size() / 2, 100);
  EXPECT_EQ(output.run(patch).height, CpuFilter(map.table, map.seams, {0.06f}).run(patch).height);
  const std::vector<float> bare(patch.size(), 0.0f);
  EXPECT_EQ(output.run(bare).height, bare);
}

TEST(CpuFilter, bothSidesOfASeamShowTheSameHeightOnTheBunny) {
  LaidOutMesh mesh = bunny();
  if (mesh.positions.empty()) GTEST_SKIP() << "shared/data/snow/stanford-bunny.obj is not there";
  const Map map = make_map(std::move(mesh));
  std::vector<float> heights = blanket(map, 0.0f);
  for (size_t i = 0; i < map.table.texel.size(); ++i) {
    const glm::vec3 at = map.mesh.positions[map.mesh.topology.triangles[3 * map.table.triangle[i]]];
    heights[map.table.texel[i]] = at.y > 0.1f ? 0.002f : 0.0f;
  }
  const auto smoothed = smooth(map, 0.0006f, heights);
  EXPECT_NEAR(volume(map, smoothed) / volume(map, heights), 1.0, 1e-5);
}

void print_times(int32_t resolution, const char* name, const std::vector<float>& stored,
                 const Map& map) {
  const auto begin = std::chrono::steady_clock::now();
  CpuFilter output(map.table, map.seams, {0.02f});
  const std::chrono::duration<double> made = std::chrono::steady_clock::now() - begin;
  double best = 1e30;
  for (int i = 0; i < 4; ++i) {
    const auto start = std::chrono::steady_clock::now();
    output.run(stored);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    best = std::min(best, taken.count());
  }
  std::printf("%d, %s: %.1f ms, set up in %.0f ms\n", resolution, name, 1e3 * best,
              1e3 * made.count());
}

TEST(MapOutput, timeOfAFullMap) {
  for (const int32_t resolution : {1024, 2048}) {
    const float size = 0.01f * static_cast<float>(resolution);
    const Map map = plate(resolution, size, size);
    print_times(resolution, "3 to 13 cm", random_map(map, 7), map);
    print_times(resolution, "30 cm", blanket(map, 0.3f), map);
    print_times(resolution, "bare patches", patchy_snow(map, 7), map);
  }
}

}  // namespace
}  // namespace snowbough::snow
