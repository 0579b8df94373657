#include "snow/output/cpu_filter.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <thread>

#include "native/snow/output/plates.h"

namespace snowbough::snow {
namespace {

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

TEST(CpuFilter, mapsMadeInParallelAreTheSame) {
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

}  // namespace
}  // namespace snowbough::snow
