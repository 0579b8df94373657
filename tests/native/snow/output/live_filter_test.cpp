#include "snow/output/gl/live_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gpu/gpu_thread.h"
#include "native/snow/layouts.h"
#include "native/snow/reference.h"

namespace snowbough::snow {
namespace {

constexpr int32_t kMapSize = 128;

/// A square metre that fills the map: a texel is 1 / 128 m.
LaidOutMesh whole_square() {
  LaidOutMesh mesh;
  mesh.topology.resolution = kMapSize;
  mesh.topology.vertex_count = 4;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.topology.triangles = {0, 1, 2, 0, 2, 3};
  for (const int32_t v : mesh.topology.triangles) {
    mesh.topology.corner_uv.emplace_back(mesh.positions[v].x, mesh.positions[v].y);
  }
  return mesh;
}

struct Filtered {
  std::vector<float> map;
  int32_t rounds = 0;
};

Filtered filtered(const LaidOutMesh& mesh, std::vector<float> map, double blur_radius) {
  const TexelTable table = build_texel_table(mesh.topology);
  const SeamTable seams = build_seam_table(mesh.topology, table, mesh.positions);
  const auto thread = gpu::GpuThread::shared();
  Filtered result;
  thread->run([&] {
    LiveFilter filter(thread, table, seams, blur_radius);
    filter.map().write(0, filter.map().bytes(), map.data());
    const gpu::ThreadTexture output = filter.run();
    result.rounds = filter.rounds();
    result.map.resize(map.size());
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    output.texture->read(0, GL_RED, GL_FLOAT, filter.map().bytes(), result.map.data());
  });
  return result;
}

TEST(LiveFilter, leavesALevelBlanketAsItIs) {
  const Filtered made =
      filtered(whole_square(), std::vector<float>(kMapSize * kMapSize, 0.1f), 0.04);
  for (const float h : made.map) ASSERT_NEAR(h, 0.1f, 1e-6f);
}

TEST(LiveFilter, roundsWithTheBlurRadiusAsSigma) {
  // A low blanket with a ridge of one texel: what the ridge becomes is the filter's own shape.
  std::vector<float> map(kMapSize * kMapSize, 1.0f);
  for (int32_t y = 0; y < kMapSize; ++y) map[y * kMapSize + kMapSize / 2] = 2.0f;
  const double sigma = 5.0;
  const Filtered made = filtered(whole_square(), map, sigma / kMapSize);
  double mass = 0.0, squares = 0.0;
  for (int32_t x = 0; x < kMapSize; ++x) {
    const double h = made.map[kMapSize / 2 * kMapSize + x] - 1.0;
    mass += h;
    squares += h * (x - kMapSize / 2) * (x - kMapSize / 2);
  }
  EXPECT_GT(made.rounds, 5);
  EXPECT_NEAR(mass, 1.0, 1e-4);
  EXPECT_NEAR(std::sqrt(squares / mass), sigma, 0.06 * sigma);
}

TEST(LiveFilter, liftsNoBareGround) {
  std::vector<float> map(kMapSize * kMapSize, 0.0f);
  for (int32_t y = 0; y < kMapSize; ++y) {
    for (int32_t x = 0; x < kMapSize / 2; ++x) map[y * kMapSize + x] = 0.1f;
  }
  const Filtered made = filtered(whole_square(), map, 0.05);
  for (size_t i = 0; i < map.size(); ++i) ASSERT_EQ(made.map[i] > 0.0f, map[i] > 0.0f);
}

TEST(LiveFilter, keepsBothSidesApart) {
  std::vector<float> map(kMapSize * kMapSize, 0.1f);
  for (int32_t y = 0; y < kMapSize; ++y) {
    for (int32_t x = 0; x < kMapSize / 2; ++x) map[y * kMapSize + x] = -0.1f;
  }
  const Filtered made = filtered(whole_square(), map, 0.05);
  for (size_t i = 0; i < map.size(); ++i) ASSERT_NEAR(made.map[i], map[i], 1e-6f);
}

TEST(LiveFilter, smoothsAcrossASeamAndBeyondTheCharts) {
  // A wave once round a tube, highest at the seam: a filter that stopped there would flatten it.
  const LaidOutMesh mesh = cylinder(48, 16, 0.5f, 2.0f, kMapSize);
  const TexelTable table = build_texel_table(mesh.topology);
  const SeamTable seams = build_seam_table(mesh.topology, table, mesh.positions);
  const auto wave = [](int32_t texel) {
    const float turn = (static_cast<float>(texel % kMapSize) + 0.5f) / kMapSize - 0.1f;
    return 0.3f + 0.1f * std::cos(6.2831853f * turn / 0.8f);
  };
  std::vector<float> map(kMapSize * kMapSize, 0.0f), values;
  for (const int32_t texel : table.texel) {
    map[texel] = wave(texel);
    values.push_back(map[texel]);
  }
  const Filtered made = filtered(mesh, map, 0.05);
  EXPECT_GT(made.rounds, 0);
  // A Gaussian of sigma s leaves exp(-(k s)^2 / 2) of a wave of number k: here 2 a metre.
  const float left = std::exp(-0.5f * 0.1f * 0.1f);
  for (const int32_t texel : table.texel) {
    ASSERT_NEAR(made.map[texel], 0.3f + left * (wave(texel) - 0.3f), 2e-3f) << texel % kMapSize;
  }
  const std::vector<float> expected = dilated(table, seams, values);
  size_t beyond = 0;
  for (const int32_t texel : seams.dilated) {
    if (expected[texel] != 0.0f) ++beyond;
    ASSERT_NEAR(made.map[texel], expected[texel], 2e-3f);
  }
  EXPECT_GT(beyond, 500u);
}

}  // namespace
}  // namespace snowbough::snow
