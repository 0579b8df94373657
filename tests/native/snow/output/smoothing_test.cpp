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
#include "snow/output/gl/gpu_filter.h"
#include "snow/output/gl/smoothing_pass.h"
#include "snow/output/output_filter.h"

namespace snowbough::snow {
namespace {

using ::testing::Each;

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

/// Standard deviation in metres along x and y of what one texel's snow in the middle is spread to.
glm::dvec2 spread_of(const Map& map, const SmoothingPlan& plan) {
  const int32_t size = map.table.resolution;
  std::vector<float> height(map.table.texel.size(), 0.0f);
  const int32_t middle = size / 2;
  height[static_cast<size_t>(middle) * size + middle] = 1.0f;
  const std::vector<float> smooth = smooth_reference(map.seams, plan, height);
  glm::dvec2 variance(0.0);
  double sum = 0.0;
  for (int32_t y = 0; y < size; ++y) {
    for (int32_t x = 0; x < size; ++x) {
      const double h = smooth[static_cast<size_t>(y) * size + x];
      const glm::dvec2 d = glm::dvec2(x - middle, y - middle) * glm::dvec2(map.seams.texel_size[0]);
      variance += h * d * d;
      sum += h;
    }
  }
  EXPECT_NEAR(sum, 1.0, 1e-5);
  return glm::sqrt(variance / sum);
}

TEST(Smoothing, everyLevelIsAFilterOfItsStandardDeviation) {
  for (int32_t level = 0; level < kFilterLevels; ++level) {
    const FilterWeights& w = filter_levels()[level];
    double sum = w[0], variance = 0.0;
    for (int k = 1; k <= kFilterReach; ++k) {
      sum += 2.0 * w[k];
      variance += 2.0 * k * k * w[k];
    }
    EXPECT_NEAR(sum, 1.0, 1e-6);
    EXPECT_NEAR(std::sqrt(variance), 1.6888 * level / 255, 1e-3);
  }
}

TEST(Smoothing, theFullFilterHasTheThesisTaps) {
  const FilterWeights& w = filter_levels()[255];
  EXPECT_NEAR(w[0], 0.2270 / 0.9998, 1e-6);
  EXPECT_NEAR(w[1] + w[2], 0.3162 / 0.9998, 1e-6);
  EXPECT_NEAR(w[3] + w[4], 0.0702 / 0.9998, 1e-6);
  EXPECT_NEAR(w[2] / (w[1] + w[2]), 0.3846, 1e-4);
  EXPECT_NEAR(w[4] / (w[3] + w[4]), 0.2307, 1e-4);
}

TEST(Smoothing, theRadiusIsInMetres) {
  for (const float texels : {0.5f, 1.0f, 2.0f, 3.0f, 6.0f}) {
    const Map map = plate(64, 6.4f, 6.4f);
    const glm::dvec2 spread = spread_of(map, plan_smoothing(map.table, map.seams, texels * 0.1f));
    EXPECT_NEAR(spread.x, texels * 0.1, 0.002 * texels);
    EXPECT_NEAR(spread.y, texels * 0.1, 0.002 * texels);
  }
}

TEST(Smoothing, aStretchedLayoutIsSmoothedEvenlyOnTheSurface) {
  const Map map = plate(128, 12.8f, 25.6f);
  const glm::dvec2 spread = spread_of(map, plan_smoothing(map.table, map.seams, 0.3f));
  EXPECT_NEAR(spread.x, 0.3, 0.005);
  EXPECT_NEAR(spread.y, 0.3, 0.005);
}

TEST(Smoothing, aLevelBlanketStaysLevelUpToItsRim) {
  LaidOutMesh mesh;
  mesh.topology.resolution = 64;
  add_plate(mesh, glm::vec2(0.1f), glm::vec2(0.77f), 0, 1, 1);
  const Map map = make_map(std::move(mesh));
  const std::vector<float> height(map.table.texel.size(), 0.25f);
  EXPECT_THAT(smooth_reference(map.seams, plan_smoothing(map.table, map.seams, 0.1f), height),
              Each(testing::FloatNear(0.25f, 1e-6f)));
}

TEST(Smoothing, nothingLeaksToAChartBesideThatIsNoNeighbourOnTheSurface) {
  LaidOutMesh mesh;
  mesh.topology.resolution = 64;
  add_plate(mesh, glm::vec2(0, 0), glm::vec2(0.5f, 1), 0, 1, 1);
  add_plate(mesh, glm::vec2(0.5f, 0), glm::vec2(1, 1), 5, 1, 1);
  const Map map = make_map(std::move(mesh));
  std::vector<float> height(map.table.texel.size());
  for (size_t i = 0; i < height.size(); ++i) height[i] = map.table.chart[i] == 0 ? 1.0f : 0.0f;
  const auto smooth =
      smooth_reference(map.seams, plan_smoothing(map.table, map.seams, 0.2f), height);
  for (size_t i = 0; i < height.size(); ++i) EXPECT_FLOAT_EQ(smooth[i], height[i]);
}

TEST(Smoothing, aRadiusOfZeroPassesTheMapOn) {
  const Map map = plate(64, 1, 1);
  const SmoothingPlan plan = plan_smoothing(map.table, map.seams, 0.0f);
  std::vector<float> height(map.table.texel.size());
  for (size_t i = 0; i < height.size(); ++i) height[i] = static_cast<float>(i % 7);
  EXPECT_EQ(output_reference(map.table, map.seams, plan, height).height, height);
}

TEST(Smoothing, aNegativeRadiusIsRefused) {
  const Map map = plate(64, 1, 1);
  EXPECT_THROW(plan_smoothing(map.table, map.seams, -1.0f), std::invalid_argument);
  EXPECT_THROW(plan_smoothing(map.table, map.seams, std::nanf("")), std::invalid_argument);
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
    stored[texel] = static_cast<float>(random() % 1000) * 1e-4f;
  return stored;
}

std::vector<float> output_on_gpu(const Map& map, const SmoothingPlan& plan,
                                 const std::vector<float>& stored, int rounds = 1) {
  return gpu::GpuThread::shared()->run([&] {
    const int32_t size = map.table.resolution;
    gpu::Texture maps(GL_R32F, size, size, 2);
    maps.write(1, GL_RED, GL_FLOAT, stored.data());
    OutputBuffers buffers = make_output_buffers(map.table, map.seams, plan);
    SmoothingPass pass;
    std::vector<float> height;
    for (int i = 0; i < rounds; ++i) {
      const auto start = std::chrono::steady_clock::now();
      pass.run(maps, 1, buffers);
      height = buffers.map.read_all<float>();
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
      if (rounds > 1) std::printf("GPU output %d: %.1f ms\n", i, 1e3 * taken.count());
    }
    return height;
  });
}

TEST(OutputFilter, onTheGpuGivesWhatTheProcessorGivesOnATube) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 128));
  const auto metrics = surface_metrics(map.mesh.topology, map.mesh.positions);
  const auto receiver = std::make_shared<SceneObject>();
  receiver->description.topology = map.mesh.topology;
  receiver->description.rest = map.mesh.positions;
  receiver->table = map.table;
  const auto stored = random_map(map, 5);
  for (const float radius : {0.0f, 0.01f, 0.1f}) {
    const SmoothingPlan plan = plan_smoothing(map.table, map.seams, radius);
    const MapOutput expected = output_reference(map.table, map.seams, plan, stored, metrics);
    OutputFilter filter(receiver, radius, false);
    const auto output = [&](const std::vector<SurfaceMetric>& wanted) {
      return gpu::GpuThread::shared()->run([&] {
        gpu::Texture maps(GL_R32F, 128, 128, 2);
        maps.write(1, GL_RED, GL_FLOAT, stored.data());
        OutputPasses passes;
        return filter_on_gpu(passes, filter, maps, 1, wanted);
      });
    };
    const MapOutput whole = output(metrics);
    MapOutput heights = output({});
    EXPECT_TRUE(heights.normal.empty());
    filter.level(heights.height);
    EXPECT_EQ(heights.height, whole.height);
    float worst = 0.0f;
    float worst_normal = 0.0f;
    ASSERT_EQ(whole.normal.size(), stored.size());
    for (size_t i = 0; i < stored.size(); ++i) {
      worst = std::max(worst, std::abs(whole.height[i] - expected.height[i]));
      worst_normal = std::max(worst_normal, glm::length(whole.normal[i] - expected.normal[i]));
    }
    EXPECT_LT(worst, 1e-6f) << "radius " << radius;
    EXPECT_LT(worst_normal, 1e-4f) << "radius " << radius;
  }
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

TEST(SmoothingPass, reachesTheLastTexelOfAMapWithMoreWorkGroupsThanOneDimensionHolds) {
  const Map map = plate(2112, 21.12f, 21.12f);
  ASSERT_GT(map.table.texel.size(), 65535u * 64u);
  const SmoothingPlan plan = plan_smoothing(map.table, map.seams, 0.0f);
  const auto stored = random_map(map, 8);
  const auto height = output_on_gpu(map, plan, stored);
  for (const int32_t texel : {map.table.texel.front(), map.table.texel.back()}) {
    EXPECT_EQ(height[texel], stored[texel]);
  }
}

TEST(SmoothingPass, twoRunsAreBitIdentical) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 128));
  const SmoothingPlan plan = plan_smoothing(map.table, map.seams, 0.1f);
  const auto stored = random_map(map, 6);
  EXPECT_EQ(output_on_gpu(map, plan, stored), output_on_gpu(map, plan, stored));
}

LaidOutMesh bunny() {
  LaidOutMesh mesh = read_obj_mesh(std::string(SNOWBOUGH_SHARED_DATA) + "/snow/stanford-bunny.obj");
  if (!mesh.positions.empty()) lay_out_by_direction(mesh, 1024, 4.0f);
  return mesh;
}

void expect_fast_agrees(const Map& map, float radius, int32_t threads, uint32_t seed = 5) {
  const SmoothingPlan plan = plan_smoothing(map.table, map.seams, radius);
  const auto stored = random_map(map, seed);
  const auto metrics = surface_metrics(map.mesh.topology, map.mesh.positions);
  const MapOutput expected = output_reference(map.table, map.seams, plan, stored, metrics);
  CpuFilter output(map.table, map.seams, plan, threads);
  const MapOutput made = output.run(stored, metrics);
  float worst = 0.0f;
  for (size_t i = 0; i < stored.size(); ++i) {
    worst = std::max(worst, std::abs(made.height[i] - expected.height[i]));
  }
  EXPECT_LT(worst, 1e-6f) << "radius " << radius << ", seed " << seed;
  EXPECT_EQ(made.normal.size(), stored.size());
  EXPECT_EQ(output.run(stored).height, made.height) << "a second run must not remember the first";
}

TEST(CpuFilter, agreesWithThePlainFilterOnATube) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 256));
  for (const float radius : {0.0f, 0.004f, 0.01f, 0.1f}) expect_fast_agrees(map, radius, 2);
}

TEST(CpuFilter, agreesWithThePlainFilterOnTheBunny) {
  LaidOutMesh mesh = bunny();
  if (mesh.positions.empty()) GTEST_SKIP() << "shared/data/snow/stanford-bunny.obj is not there";
  const Map map = make_map(std::move(mesh));
  for (const uint32_t seed : {5, 6, 7, 8, 9}) expect_fast_agrees(map, 0.0006f, 2, seed);
}

TEST(CpuFilter, doesNotDependOnTheNumberOfThreads) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 256));
  const SmoothingPlan plan = plan_smoothing(map.table, map.seams, 0.03f);
  const auto stored = random_map(map, 5);
  const auto one = CpuFilter(map.table, map.seams, plan, 1).run(stored).height;
  EXPECT_EQ(CpuFilter(map.table, map.seams, plan, 3).run(stored).height, one);
}

TEST(CpuFilter, mapsMadeAtOnceAreWhatTheyAreAlone) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 256));
  const SmoothingPlan plan = plan_smoothing(map.table, map.seams, 0.03f);
  CpuFilter output(map.table, map.seams, plan);
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

TEST(CpuFilter, patchesOfSnowSpreadLikeThePlainFilterAlsoAcrossSeams) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 320));
  const SmoothingPlan plan = plan_smoothing(map.table, map.seams, 0.06f);
  CpuFilter output(map.table, map.seams, plan);
  const size_t texels = map.table.texel.size();
  for (size_t first = 0; first + 3 < texels; first += texels / 8) {
    const auto stored = patch_of(map, first, 3);
    const auto expected = output_reference(map.table, map.seams, plan, stored).height;
    const auto height = output.run(stored).height;
    float worst = 0.0f;
    for (size_t i = 0; i < height.size(); ++i)
      worst = std::max(worst, std::abs(height[i] - expected[i]));
    ASSERT_LT(worst, 1e-7f) << "patch at " << first;
  }
}

TEST(CpuFilter, nothingStaysWhereSnowIsGone) {
  const Map map = make_map(cylinder(24, 8, 0.5f, 2.0f, 512));
  const SmoothingPlan plan = plan_smoothing(map.table, map.seams, 0.06f);
  CpuFilter output(map.table, map.seams, plan);
  output.run(random_map(map, 5));
  const auto patch = patch_of(map, map.table.texel.size() / 2, 100);
  EXPECT_EQ(output.run(patch).height, CpuFilter(map.table, map.seams, plan).run(patch).height);
  const std::vector<float> bare(patch.size(), 0.0f);
  EXPECT_EQ(output.run(bare).height, bare);
}

TEST(MapOutput, timeOfAFullMapOf1024) {
  const Map map = plate(1024, 10.24f, 10.24f);
  const auto stored = random_map(map, 7);
  const SmoothingPlan plan = plan_smoothing(map.table, map.seams, 0.02f);
  EXPECT_EQ(plan.passes, 1);
  EXPECT_EQ(plan.closing_passes, 2);
  CpuFilter output(map.table, map.seams, plan);
  std::vector<float> expected;
  for (int i = 0; i < 4; ++i) {
    const auto start = std::chrono::steady_clock::now();
    expected = output.run(stored).height;
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    std::printf("processor: %.1f ms for a blur of 2 texels\n", 1e3 * taken.count());
  }
  const auto height = output_on_gpu(map, plan, stored, 2);
  EXPECT_NEAR(height[512 * 1024 + 512], expected[512 * 1024 + 512], 1e-6f);
}

}  // namespace
}  // namespace snowbough::snow
