#include "snow/seams/seam_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <random>

#include "native/snow/layouts.h"
#include "native/snow/reference.h"
#include "snow/output/dilate.h"
#include "snow/output/smoothing.h"
#include "snow/seams/seam_leveller.h"
#include "snow/texels/charts.h"

namespace snowbough::snow {
namespace {

/// A cube of side 1, every face a chart of its own, turned and mirrored differently.
LaidOutMesh cube(int32_t resolution) {
  LaidOutMesh mesh;
  mesh.topology.resolution = resolution;
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  mesh.topology.vertex_count = 8;
  const int32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                               {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (int f = 0; f < 6; ++f) {
    const glm::vec2 low(0.04f + 0.32f * static_cast<float>(f % 3),
                        0.1f + 0.45f * static_cast<float>(f / 3));
    const glm::vec2 corner[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const auto uv = [&](int k) {
      glm::vec2 c = corner[(k + f) % 4];
      if (f % 2 == 1) c.x = 1.0f - c.x;
      return low + 0.28f * c;
    };
    for (const int k : {0, 1, 2, 0, 2, 3}) {
      mesh.topology.triangles.push_back(faces[f][k]);
      mesh.topology.corner_uv.push_back(uv(k));
    }
  }
  return mesh;
}

glm::vec3 surface_point(const LaidOutMesh& mesh, const TexelTable& table, size_t i) {
  const int32_t* c = mesh.topology.triangles.data() + 3 * static_cast<size_t>(table.triangle[i]);
  const glm::vec2 w = table.barycentric[i];
  return mesh.positions[c[0]] * (1.0f - w.x - w.y) + mesh.positions[c[1]] * w.x +
         mesh.positions[c[2]] * w.y;
}

float mean_texel_size(const SeamTable& seams) {
  double sum = 0.0;
  for (const glm::vec2 s : seams.texel_size) sum += 0.5 * (s.x + s.y);
  return static_cast<float>(sum / static_cast<double>(seams.texel_size.size()));
}

float bilinear(const std::vector<float>& map, int32_t resolution, glm::vec2 uv) {
  const glm::vec2 p = uv * static_cast<float>(resolution) - 0.5f;
  const auto x = static_cast<int32_t>(std::floor(p.x)), y = static_cast<int32_t>(std::floor(p.y));
  const float fx = p.x - static_cast<float>(x), fy = p.y - static_cast<float>(y);
  const auto at = [&](int32_t i, int32_t j) {
    i = std::clamp(i, 0, resolution - 1);
    j = std::clamp(j, 0, resolution - 1);
    return map[static_cast<size_t>(j) * resolution + i];
  };
  return (at(x, y) * (1 - fx) + at(x + 1, y) * fx) * (1 - fy) +
         (at(x, y + 1) * (1 - fx) + at(x + 1, y + 1) * fx) * fy;
}

/// Relative differences of the heights that both sides of all seams show where there is more than
/// `from` of the largest height, sorted.
std::vector<float> seam_differences(const LaidOutMesh& mesh, const std::vector<float>& map,
                                    float from = 0.02f) {
  std::vector<float> differences;
  const float highest = *std::max_element(map.begin(), map.end());
  for (const Seam& seam : find_charts(mesh.topology).seams) {
    const auto uv = [&](TriangleEdge e, float t) {
      const glm::vec2* c = mesh.topology.corner_uv.data() + 3 * static_cast<size_t>(e.triangle);
      return c[e.edge] * (1 - t) + c[(e.edge + 1) % 3] * t;
    };
    const float length =
        glm::length(uv(seam.a, 0) - uv(seam.a, 1)) * static_cast<float>(mesh.topology.resolution);
    const int steps = std::max(1, static_cast<int>(3.0f * length));
    for (int s = 0; s < steps; ++s) {
      const float t = (static_cast<float>(s) + 0.5f) / static_cast<float>(steps);
      const float a = bilinear(map, mesh.topology.resolution, uv(seam.a, t));
      const float b =
          bilinear(map, mesh.topology.resolution, uv(seam.b, seam.same_direction ? t : 1 - t));
      const float local = 0.5f * (a + b);
      if (local > from * highest) differences.push_back(std::abs(a - b) / local);
    }
  }
  std::sort(differences.begin(), differences.end());
  return differences;
}

/// Snow as a step leaves it: deeper where it is level, cut off sharply by shadows, grainy.
std::vector<float> fallen_snow(const LaidOutMesh& mesh, const TexelTable& table, float scale,
                               uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> grain(0.7f, 1.3f);
  std::vector<float> height(table.texel.size());
  for (size_t i = 0; i < height.size(); ++i) {
    const glm::vec3 p = surface_point(mesh, table, i) / scale;
    const bool lit = std::sin(p.x) + std::sin(p.y + 1.0f) + std::sin(p.z + 2.0f) > -0.5f;
    height[i] = (lit ? 0.08f : 0.02f) * grain(random);
  }
  return height;
}

/// Snow on one side of a sharp shadow, nothing on the other.
std::vector<float> half_shaded(const LaidOutMesh& mesh, const TexelTable& table) {
  std::vector<float> height(table.texel.size());
  for (size_t i = 0; i < height.size(); ++i) {
    const glm::vec3 p = surface_point(mesh, table, i);
    height[i] = p.x + 0.7f * p.y + 0.4f * p.z > 1.03f ? 0.1f : 0.0f;
  }
  return height;
}

void expect_even_seams(const LaidOutMesh& mesh, const char* name, float shadow_texels) {
  const TexelTable table = build_texel_table(mesh.topology);
  const auto start = std::chrono::steady_clock::now();
  const SeamTable seams = build_seam_table(mesh.topology, table, mesh.positions);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  const float size = mean_texel_size(seams);
  const float radius = 3.0f * size;
  const auto height = fallen_snow(mesh, table, shadow_texels * size, 3);
  const auto smooth_start = std::chrono::steady_clock::now();
  const auto smooth = smoothed(table, seams, radius, height);
  const std::chrono::duration<double> smooth_taken =
      std::chrono::steady_clock::now() - smooth_start;
  auto map = dilated(table, seams, smooth);
  SeamLeveller(seams.levelling).run(map);
  const auto differences = seam_differences(mesh, map);
  ASSERT_GT(differences.size(), 100u);
  std::printf(
      "%s: %d charts, %zu texels, %zu ghosts, %.1f ms, table %.0f ms; seam p50 %.4f p99 "
      "%.4f max %.4f\n",
      name, table.chart_count, table.texel.size(),
      seams.u.ghost_place.size() + seams.v.ghost_place.size(), 1e3 * smooth_taken.count(),
      1e3 * taken.count(), differences[differences.size() / 2],
      differences[differences.size() * 99 / 100], differences.back());
  EXPECT_LT(differences[differences.size() * 99 / 100], 0.01f);
}

TEST(Seams, bothSidesCarryTheSameHeightOnACube) {
  expect_even_seams(cube(512), "cube", 15.0f);
}

TEST(Seams, bothSidesCarryTheSameHeightOnACylinder) {
  expect_even_seams(cylinder(48, 16, 0.5f, 2.0f, 512), "cylinder", 15.0f);
}

/// One round of plain averaging: every texel takes half of the mean difference at its points.
void average_seams(const SeamLevelling& levelling, std::vector<float>& map) {
  const auto count = static_cast<size_t>(levelling.unknowns);
  std::vector<float> change(count, 0.0f);
  std::vector<float> weight(count, 0.0f);
  const auto for_each_term = [&](const SeamRow& point, const auto& work) {
    for (int32_t t = 0; t < kSeamTerms; ++t) {
      const auto source = static_cast<size_t>(point.source[t]);
      if (source < levelling.texel.size()) work(source, point.weight[t]);
    }
  };
  for (const SeamRow& point : levelling.points) {
    float gap = 0.0f;
    for_each_term(point, [&](size_t i, float w) { gap += w * map[levelling.texel[i]]; });
    for_each_term(point, [&](size_t i, float w) {
      if (i >= count) return;
      change[i] -= 0.5f * w * gap;
      weight[i] += std::abs(w);
    });
  }
  for (size_t i = 0; i < count; ++i) {
    float& height = map[levelling.texel[i]];
    height = std::max(0.0f, height + change[i] / weight[i]);
  }
}

TEST(Seams, bothSidesCarryTheSameHeightWhereSnowThinsOut) {
  LaidOutMesh mesh = cube(256);
  const TexelTable table = build_texel_table(mesh.topology);
  const SeamTable seams = build_seam_table(mesh.topology, table, mesh.positions);
  const float radius = 3.0f * mean_texel_size(seams);
  auto map = dilated(table, seams, smoothed(table, seams, radius, half_shaded(mesh, table)));
  const auto p99 = [&](const std::vector<float>& of) {
    const auto differences = seam_differences(mesh, of, 0.01f);
    return differences[differences.size() * 99 / 100];
  };
  const float before = p99(map);
  auto averaged = map;
  for (int round = 0; round < 3; ++round) average_seams(seams.levelling, averaged);
  SeamLeveller(seams.levelling).run(map);
  std::printf("thin snow: p99 %.4f; averaged %.4f; levelled %.4f\n", before, p99(averaged),
              p99(map));
  EXPECT_LT(p99(map), 0.5f * before);
  EXPECT_LT(p99(map), p99(averaged));
}

TEST(Seams, bothSidesCarryTheSameHeightWhereEveryTriangleIsAChart) {
  LaidOutMesh mesh = cylinder(24, 8, 0.5f, 2.0f, 512);
  lay_out_apart(mesh, 512);
  expect_even_seams(mesh, "cylinder in triangles", 15.0f);
}

TEST(Seams, aLayoutOfTinyChartsIsLevelled) {
  LaidOutMesh mesh = cylinder(72, 32, 0.5f, 2.0f, 512);
  lay_out_apart(mesh, 512);
  const TexelTable table = build_texel_table(mesh.topology);
  const SeamTable seams = build_seam_table(mesh.topology, table, mesh.positions);
  const float radius = 3.0f * mean_texel_size(seams);
  const auto snow = fallen_snow(mesh, table, 15.0f * mean_texel_size(seams), 3);
  const auto map = dilated(table, seams, smoothed(table, seams, radius, snow));
  auto levelled = map;
  SeamLeveller(seams.levelling).run(levelled);
  const auto p99 = [&](const std::vector<float>& of) {
    const auto differences = seam_differences(mesh, of);
    return differences[differences.size() * 99 / 100];
  };
  std::printf("tiny charts: %d texels at seams, p99 %.4f, levelled %.4f\n",
              seams.levelling.unknowns, p99(map), p99(levelled));
  EXPECT_LT(p99(levelled), 0.5f * p99(map));
}

TEST(Seams, levelledHeightsStayInRangeAndDependOnTheirMapOnly) {
  LaidOutMesh mesh = cube(128);
  const TexelTable table = build_texel_table(mesh.topology);
  const SeamTable seams = build_seam_table(mesh.topology, table, mesh.positions);
  const auto first = dilated(table, seams, half_shaded(mesh, table));
  const auto other = dilated(table, seams, fallen_snow(mesh, table, 0.05f, 9));
  SeamLeveller fresh(seams.levelling);
  SeamLeveller used(seams.levelling);
  auto map = other;
  used.run(map);
  auto again = first;
  used.run(again);
  map = first;
  fresh.run(map);
  EXPECT_GE(*std::min_element(map.begin(), map.end()), 0.0f);
  EXPECT_LE(*std::max_element(map.begin(), map.end()),
            *std::max_element(first.begin(), first.end()));
  EXPECT_EQ(again, map);
}

TEST(Seams, aMeshThatIsScaledToNothingKeepsItsHeights) {
  LaidOutMesh mesh = cube(64);
  const TexelTable table = build_texel_table(mesh.topology);
  std::fill(mesh.positions.begin(), mesh.positions.end(), glm::vec3(1.0f));
  const SeamTable seams = build_seam_table(mesh.topology, table, mesh.positions);
  EXPECT_GT(seams.levelling.least_height, 0.0f);
  std::vector<float> map(64 * 64);
  for (size_t i = 0; i < map.size(); ++i) map[i] = 0.01f * static_cast<float>(i % 7);
  SeamLeveller(seams.levelling).run(map);
  for (const float height : map) {
    ASSERT_GE(height, 0.0f);
    ASSERT_LE(height, 0.06f);
  }
}

TEST(Seams, bothSidesCarryTheSameHeightOnTheBunny) {
  LaidOutMesh mesh = read_obj_mesh(std::string(SNOWBOUGH_SHARED_DATA) + "/snow/stanford-bunny.obj");
  if (mesh.positions.empty()) GTEST_SKIP() << "shared/data/snow/stanford-bunny.obj is not there";
  lay_out_by_direction(mesh, 1024, 4.0f);
  expect_even_seams(mesh, "bunny", 15.0f);
}

}  // namespace
}  // namespace snowbough::snow
