#include "snow/seams/curvature.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>

#include "native/snow/layouts.h"
#include "snow/output/cpu_filter.h"
#include "snow/seams/layer_height.h"
#include "snow/seams/seam_table.h"

namespace snowbough::snow {
namespace {

/// All corners smooth, those of one vertex alike.
std::vector<int32_t> smooth(const MapTopology& topology) {
  return topology.triangles;
}

/// A sheet of n x n quads over the unit square of the map, `place(u, v)` in space.
LaidOutMesh sheet(int32_t n, int32_t resolution,
                  const std::function<glm::vec3(float u, float v)>& place) {
  LaidOutMesh mesh;
  mesh.topology.resolution = resolution;
  const auto part = [&](int32_t i) { return static_cast<float>(i) / static_cast<float>(n); };
  for (int32_t j = 0; j <= n; ++j) {
    for (int32_t i = 0; i <= n; ++i) mesh.positions.push_back(place(part(i), part(j)));
  }
  mesh.topology.vertex_count = static_cast<int32_t>(mesh.positions.size());
  const auto corner = [&](int32_t i, int32_t j) {
    mesh.topology.triangles.push_back(j * (n + 1) + i);
    mesh.topology.corner_uv.emplace_back(part(i), part(j));
  };
  for (int32_t j = 0; j < n; ++j) {
    for (int32_t i = 0; i < n; ++i) {
      for (const auto& [di, dj] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) {
        corner(i + di, j + dj);
      }
    }
  }
  return mesh;
}

/// A part of a ball of that radius around its equator.
LaidOutMesh ball(int32_t n, float radius) {
  return sheet(n, 256, [=](float u, float v) {
    const float around = 3.0f * u;
    const float up = 2.0f * (v - 0.5f);
    return radius * glm::vec3(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around),
                              std::sin(up));
  });
}

glm::vec3 normal_of(const LaidOutMesh& mesh, const std::vector<glm::vec3>& normals, size_t t,
                    glm::vec2 w) {
  const int32_t* corner = &mesh.topology.triangles[3 * t];
  return glm::normalize(normals[corner[0]] * (1.0f - w.x - w.y) + normals[corner[1]] * w.x +
                        normals[corner[2]] * w.y);
}

/// Volume between a mesh and the same displaced by a map's height, every triangle cut into k x k,
/// along interpolated normals, as the shell displaces it.
double displaced_volume(const LaidOutMesh& mesh, const std::vector<float>& map, int32_t k) {
  std::vector<glm::vec3> normals(mesh.positions.size(), glm::vec3(0.0f));
  for (size_t t = 0; t < mesh.topology.triangles.size() / 3; ++t) {
    glm::vec3 p[3];
    for (size_t c = 0; c < 3; ++c) p[c] = mesh.positions[mesh.topology.triangles[3 * t + c]];
    const glm::vec3 n = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
    for (size_t c = 0; c < 3; ++c) {
      const glm::vec3 a = glm::normalize(p[(c + 1) % 3] - p[c]);
      const glm::vec3 b = glm::normalize(p[(c + 2) % 3] - p[c]);
      normals[mesh.topology.triangles[3 * t + c]] += n * std::acos(glm::dot(a, b));
    }
  }
  const int32_t size = mesh.topology.resolution;
  const auto height_at = [&](glm::vec2 uv) {
    const glm::vec2 at = uv * static_cast<float>(size) - 0.5f;
    const glm::vec2 corner = glm::floor(at);
    float sum = 0.0f;
    for (int d = 0; d < 4; ++d) {
      const glm::vec2 step(d & 1, d >> 1);
      const glm::vec2 part = glm::mix(1.0f - (at - corner), at - corner, step);
      const glm::ivec2 texel =
          glm::clamp(glm::ivec2(corner + step), glm::ivec2(0), glm::ivec2(size - 1));
      sum += part.x * part.y * map[static_cast<size_t>(texel.y) * size + texel.x];
    }
    return sum;
  };
  double volume = 0.0;
  const auto tetrahedron = [](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d) {
    return glm::dot(glm::cross(b - a, c - a), d - a) / 6.0;
  };
  for (size_t t = 0; t < mesh.topology.triangles.size() / 3; ++t) {
    const auto at = [&](int32_t i, int32_t j, bool displaced) {
      const glm::vec2 w = glm::vec2(i, j) / static_cast<float>(k);
      glm::vec3 p(0.0f);
      glm::vec2 uv(0.0f);
      const float part[3] = {1.0f - w.x - w.y, w.x, w.y};
      for (size_t c = 0; c < 3; ++c) {
        p += part[c] * mesh.positions[mesh.topology.triangles[3 * t + c]];
        uv += part[c] * mesh.topology.corner_uv[3 * t + c];
      }
      return glm::dvec3(displaced ? p + height_at(uv) * normal_of(mesh, normals, t, w) : p);
    };
    const auto prism = [&](std::array<glm::ivec2, 3> corner) {
      glm::dvec3 low[3], high[3];
      for (size_t c = 0; c < 3; ++c) {
        low[c] = at(corner[c].x, corner[c].y, false);
        high[c] = at(corner[c].x, corner[c].y, true);
      }
      // Walls are bilinear: the mean over both ways of cutting each of them.
      for (const auto& [a, b, c] : {std::array{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}) {
        const double one = tetrahedron(low[a], low[b], low[c], high[a]) +
                           tetrahedron(low[b], low[c], high[a], high[b]) +
                           tetrahedron(low[c], high[a], high[b], high[c]);
        const double other = tetrahedron(low[a], low[c], low[b], high[a]) +
                             tetrahedron(low[c], low[b], high[a], high[c]) +
                             tetrahedron(low[b], high[a], high[c], high[b]);
        volume += (one - other) / 6.0;
      }
    };
    for (int32_t j = 0; j < k; ++j) {
      for (int32_t i = 0; i + j < k; ++i) {
        prism({glm::ivec2(i, j), {i + 1, j}, {i, j + 1}});
        if (i + j + 1 < k) prism({glm::ivec2(i + 1, j), {i + 1, j + 1}, {i, j + 1}});
      }
    }
  }
  return volume;
}

struct Shown {
  double held;
  double shown;
  double uncorrected;
};

/// The volumes that a map with heights `depth(position)` holds and shows.
Shown shown(const LaidOutMesh& mesh, const std::function<float(glm::vec3)>& depth) {
  const TexelTable table = build_texel_table(mesh.topology);
  const SeamTable seams = build_seam_table(mesh.topology, table, mesh.positions);
  std::vector<float> map(static_cast<size_t>(table.resolution) * table.resolution, 0.0f);
  Shown result{};
  for (size_t i = 0; i < table.texel.size(); ++i) {
    const int32_t* c = &mesh.topology.triangles[3 * static_cast<size_t>(table.triangle[i])];
    const glm::vec2 w = table.barycentric[i];
    const glm::vec3 at = mesh.positions[c[0]] * (1.0f - w.x - w.y) + mesh.positions[c[1]] * w.x +
                         mesh.positions[c[2]] * w.y;
    map[table.texel[i]] = depth(at);
    result.held += double{seams.texel_area[i]} * depth(at);
  }
  result.uncorrected = displaced_volume(mesh, map, 6);
  OutputPose surface;
  surface.layers = std::make_shared<const std::vector<LayerTerms>>(
      layer_terms(mesh.topology.triangles, smooth(mesh.topology), mesh.positions));
  const MapOutput output = CpuFilter(table, seams, {0.0f}).run(map, surface);
  result.shown = displaced_volume(mesh, output.height, 6);
  return result;
}

float layer_height(float held, LayerTerms terms) {
  LayerBlock<1> layer;
  layer.set(0, held, terms);
  raise_layers(layer.view(), 1);
  return layer.height[0];
}

TEST(LayerHeight, isWhatIsHeldOnFlatGround) {
  EXPECT_FLOAT_EQ(layer_height(0.05f, {1, 0, 0}), 0.05f);
  EXPECT_FLOAT_EQ(layer_height(-0.05f, {1, 0, 0}), -0.05f);
}

TEST(LayerHeight, isTheSameSideBySideAsAlone) {
  // More than a register holds, and an odd number: convex, hollow, flat, the back, and a fold.
  constexpr int32_t kCount = 37;
  LayerBlock<kCount> layers;
  std::vector<float> alone;
  for (int32_t k = 0; k < kCount; ++k) {
    const float held = 0.01f * static_cast<float>(k - 7);
    const LayerTerms terms(0.8f + 0.01f * static_cast<float>(k), static_cast<float>(k % 9 - 4),
                           static_cast<float>(k % 5 - 1));
    layers.set(k, held, terms);
    alone.push_back(layer_height(held, terms));
  }
  raise_layers(layers.view(), kCount);
  EXPECT_THAT(layers.height, testing::ElementsAreArray(alone));
}

TEST(LayerHeight, solvesSteinersFormulaOnATwigAndABall) {
  // A twig of 1 cm radius that holds 5 cm: h + h^2 / 2R = held.
  const float twig = layer_height(0.05f, {1, 50, 0});
  EXPECT_NEAR(twig, 0.01f * (std::sqrt(11.0f) - 1.0f), 1e-5f);
  // A ball of 0.4 m under 0.12 m: ((R + h)^3 - R^3) / 3R^2 = held.
  const float ball = layer_height(0.12f, {1, 2.5f, 1.0f / (3 * 0.16f)});
  EXPECT_NEAR((std::pow(0.4f + ball, 3.0f) - std::pow(0.4f, 3.0f)) / (3 * 0.16f), 0.12f, 1e-5f);
}

TEST(LayerHeight, onTheBackTheSurfaceCurvesTheOtherWayRound) {
  EXPECT_NEAR(layer_height(-0.002f, {1, 50, 0}), -layer_height(0.002f, {1, -50, 0}), 1e-9f);
  EXPECT_LT(layer_height(-0.002f, {1, 50, 0}), -0.002f);
}

TEST(LayerHeight, inHollowsItEndsBeforeTheLayerFoldsOverItself) {
  for (const float held : {0.001f, 0.004f, 0.005f, 0.02f, 1.0f}) {
    const float height = layer_height(held, {1, -50, 0});  // a gutter of 1 cm radius
    EXPECT_GE(height, held < 0.005f ? held : 0.0f);
    EXPECT_LT(height, 0.01f);
    const float hollow_ball = layer_height(held, {1, -100, 10000.0f / 3});
    EXPECT_GT(hollow_ball, 0.0f);
    EXPECT_LT(hollow_ball, 0.01f);
  }
}

TEST(LayerTerms, ofFlatShadingAreFlat) {
  const LaidOutMesh mesh = ball(8, 0.4f);
  EXPECT_TRUE(layer_terms(mesh.topology.triangles, {}, mesh.positions).empty());
  const std::vector<int32_t> none(mesh.topology.triangles.size(), -1);
  EXPECT_TRUE(layer_terms(mesh.topology.triangles, none, mesh.positions).empty());
  std::vector<int32_t> half = mesh.topology.triangles;
  std::fill(half.begin(), half.begin() + 3, -1);
  EXPECT_EQ(layer_terms(mesh.topology.triangles, half, mesh.positions)[1], LayerTerms(1, 0, 0));
}

TEST(LayerTerms, ofABallAreItsCurvatures) {
  const LaidOutMesh mesh = ball(48, 0.4f);
  const auto terms = layer_terms(mesh.topology.triangles, smooth(mesh.topology), mesh.positions);
  // A corner in the middle.
  const LayerTerms middle = terms[3 * (2 * (24 * 48 + 24))];
  EXPECT_NEAR(middle.x, 1.0f, 2e-3f);
  EXPECT_NEAR(middle.y, 2.5f, 0.02f);
  EXPECT_NEAR(middle.z, 1.0f / (3 * 0.16f), 0.05f);
}

void expect_as_much_as_fell(const Shown& result, double error) {
  ASSERT_GT(result.held, 0.0);
  EXPECT_NEAR(result.shown / result.held, 1.0, error);
  std::printf("shown %.4f of what is held, without Steiner %.4f\n", result.shown / result.held,
              result.uncorrected / result.held);
}

TEST(ShownVolume, onAPlane) {
  expect_as_much_as_fell(
      shown(sheet(4, 128, [](float u, float v) { return glm::vec3(u, v, 0.3f * u); }),
            [](glm::vec3 p) { return 0.05f + 0.02f * p.x; }),
      1e-3);
}

TEST(ShownVolume, onABallOfFewFacesAndOfMany) {
  for (const int32_t n : {8, 48}) {
    expect_as_much_as_fell(
        shown(ball(n, 0.4f), [](glm::vec3 p) { return 0.12f * std::max(0.0f, p.z / 0.4f); }),
        0.005);
  }
}

TEST(ShownVolume, onATwigThinnerThanItsSnow) {
  for (const int32_t around : {8, 16, 64}) {
    expect_as_much_as_fell(shown(cylinder(around, 24, 0.01f, 0.3f, 256),
                                 [](glm::vec3 p) { return 0.05f * std::max(0.0f, p.y / 0.01f); }),
                           0.01);
  }
}

TEST(ShownVolume, onASaddle) {
  expect_as_much_as_fell(shown(sheet(24, 256,
                                     [](float u, float v) {
                                       const glm::vec2 p = glm::vec2(u, v) - 0.5f;
                                       return glm::vec3(p, 1.2f * (p.x * p.x - p.y * p.y));
                                     }),
                               [](glm::vec3) { return 0.1f; }),
                         0.005);
}

}  // namespace
}  // namespace snowbough::snow
