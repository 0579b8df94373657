#include "tree/uv/snow_uvs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "native/tree/uv/limbs.h"

namespace snowbough::tree {
namespace {

using test::find_quad;
using test::LimbBuilder;
using test::measure_snow;
using test::Ring;

float signed_area(const QuadUv& uv) {
  float twice = 0.0f;
  for (int i = 0; i < 4; ++i) {
    twice += uv[i].x * uv[(i + 1) % 4].y - uv[i].y * uv[(i + 1) % 4].x;
  }
  return 0.5f * twice;
}

/// Limbs as a tree has them: a few thick ones, many thin ones.
LimbBuilder random_limbs(unsigned seed, int count) {
  LimbBuilder limbs;
  std::mt19937 random(seed);
  const auto unit = [&random] { return static_cast<float>(random()) / 4294967296.0f; };
  for (int i = 0; i < count; ++i) {
    const float length = 0.05f + 3.0f * unit() * unit() * unit();
    const float radius = length * (0.004f + 0.03f * unit());
    const glm::vec3 root(unit(), unit(), unit());
    const glm::vec3 way(unit() - 0.5f, unit() - 0.5f, unit() - 0.3f);
    const auto rows = 1 + static_cast<int32_t>(random() % 9);
    limbs.add_limb(root, root + glm::normalize(way) * length, radius, radius * unit(), rows);
  }
  return limbs;
}

/// A limb of three rows whose middle row has, on side 1, an inset around the hole of a thin child.
LimbBuilder limb_with_inset() {
  LimbBuilder limbs;
  const int32_t parent = limbs.add_branch(-1);
  std::vector<Ring> rings;
  for (int i = 0; i < 4; ++i) {
    rings.push_back(limbs.add_ring({0, 0, i}, {0, 0, 1}, 1.0f));
  }
  limbs.add_root_cap(parent, rings[0]);
  limbs.add_row(parent, 0, rings[0], rings[1]);
  for (const int side : {0, 2, 3}) {
    limbs.add_wall(parent, 1, side, rings[1], rings[2]);
  }
  const std::array<int32_t, 4> cell{rings[1][1], rings[1][2], rings[2][2], rings[2][1]};
  const auto inner = static_cast<int32_t>(limbs.mesh.vertices.size());
  const auto at = [&](int corner) { return limbs.mesh.vertices[cell[corner]]; };
  for (const auto& [u, v] : {std::pair{0.25f, 0.5f}, {0.75f, 0.5f}, {0.75f, 0.9f}, {0.25f, 0.9f}}) {
    limbs.mesh.vertices.push_back(at(0) + u * (at(1) - at(0)) + v * (at(3) - at(0)));
  }
  for (int32_t k = 0; k < 4; ++k) {
    const int32_t next = (k + 1) % 4;
    limbs.add_quad({cell[k], cell[next], inner + next, inner + k},
                   {parent, 1, 1, k, FacePart::kInset});
  }
  limbs.add_row(parent, 2, rings[2], rings[3]);
  limbs.add_tip_cap(parent, 3, rings[3]);
  const int32_t child = limbs.add_branch(parent);
  const Ring end = limbs.add_ring({-3, 3, 1.7f}, {-1, 1, 0}, 0.1f);
  limbs.add_row(child, 0, {inner, inner + 1, inner + 2, inner + 3}, end);
  limbs.add_tip_cap(child, 1, end);
  return limbs;
}

TEST(SnowUvs, EveryFaceOfALimbHasItsShareOfTexels) {
  LimbBuilder limbs;
  limbs.add_limb({0, 0, 0}, {0, 0, 1}, 0.5f, 0.3f, 5);
  layout_snow_uvs(limbs.mesh, limbs.skeleton, 256);
  const UvLayoutMeasure measure = measure_snow(limbs.mesh, 256);
  EXPECT_EQ(measure.chart_count, 1);
  EXPECT_EQ(measure.outside_faces, 0);
  EXPECT_GT(measure.min_face_area, 1.0);
  EXPECT_LT(measure.density_p95 / measure.density_p5, 1.02);
}

TEST(SnowUvs, NeighbouringSidesMeetAtTheSameCoordinatesButAtTheSeam) {
  LimbBuilder limbs;
  limbs.add_limb({0, 0, 0}, {0.6f, 0, 0}, 0.3f, 0.2f, 4);
  layout_snow_uvs(limbs.mesh, limbs.skeleton, 128);
  const TreeMesh& mesh = limbs.mesh;
  for (int32_t row = 0; row < 4; ++row) {
    for (int32_t side = 0; side < 4; ++side) {
      const int32_t left = find_quad(mesh, 0, row, side);
      const int32_t right = find_quad(mesh, 0, row, (side + 1) % 4);
      const float height = mesh.vertices[mesh.quads[left][1]].z;
      const bool seam = height < -0.05f;
      EXPECT_EQ(mesh.uv_snow[left][1] != mesh.uv_snow[right][0], seam) << row << ", " << side;
      EXPECT_EQ(mesh.uv_snow[left][2] != mesh.uv_snow[right][3], seam) << row << ", " << side;
      if (row > 0) {
        EXPECT_EQ(mesh.uv_snow[left][0], mesh.uv_snow[find_quad(mesh, 0, row - 1, side)][3]);
      }
    }
  }
}

TEST(SnowUvs, CapsHangOnTheStripsEnds) {
  LimbBuilder limbs;
  limbs.add_limb({0, 0, 0}, {0, 0, 0.6f}, 0.3f, 0.2f, 2);
  layout_snow_uvs(limbs.mesh, limbs.skeleton, 128);
  EXPECT_EQ(measure_snow(limbs.mesh, 128).chart_count, 1);
  const int32_t root = find_quad(limbs.mesh, 0, 0, 0, FacePart::kRootCap);
  const int32_t tip = find_quad(limbs.mesh, 0, 2, 0, FacePart::kTipCap);
  // Areas are in the ratio of the squares of the radii.
  EXPECT_NEAR(signed_area(limbs.mesh.uv_snow[tip]) / signed_area(limbs.mesh.uv_snow[root]),
              4.0f / 9.0f, 0.01f);
}

TEST(SnowUvs, InsetsLieInTheirKnucklesCellAroundTheHole) {
  LimbBuilder limbs = limb_with_inset();
  layout_snow_uvs(limbs.mesh, limbs.skeleton, 256);
  const UvLayoutMeasure measure = measure_snow(limbs.mesh, 256);
  EXPECT_EQ(measure.chart_count, 2);
  EXPECT_EQ(measure.overlap_texels, 0);
  EXPECT_GT(measure.min_face_area, 1.0);
  // The hole takes 0.5 x 0.4 of the cell: the insets have four fifths of the opposite wall's area.
  float insets = 0.0f;
  for (int k = 0; k < 4; ++k) {
    insets += signed_area(limbs.mesh.uv_snow[find_quad(limbs.mesh, 0, 1, 1, FacePart::kInset, k)]);
  }
  const float wall = signed_area(limbs.mesh.uv_snow[find_quad(limbs.mesh, 0, 1, 3)]);
  EXPECT_NEAR(insets / wall, 0.8f, 1e-3f);
}

TEST(SnowUvs, WidensThinLimbsToTwoTexels) {
  LimbBuilder limbs;
  limbs.add_limb({0, 0, 0}, {0, 0, 4}, 0.5f, 0.5f, 4);
  limbs.add_limb({5, 0, 0}, {5, 0, 4}, 0.001f, 0.0001f, 4);
  layout_snow_uvs(limbs.mesh, limbs.skeleton, 128);
  const int32_t left = find_quad(limbs.mesh, 1, 0, 0);
  double width = 0.0;
  for (int32_t side = 0; side < 4; ++side) {
    const QuadUv& uv = limbs.mesh.uv_snow[left + side];
    width += 128.0 * glm::distance(uv[2], uv[3]);
  }
  EXPECT_NEAR(width, 2.0, 1e-4);
  EXPECT_GE(measure_snow(limbs.mesh, 128).min_chart_extent, 2.0 - 1e-4);
}

TEST(SnowUvs, CutsALimbLongerThanTheMap) {
  LimbBuilder limbs;
  limbs.add_limb({0, 0, 0}, {0, 0, 100}, 0.1f, 0.1f, 200);
  layout_snow_uvs(limbs.mesh, limbs.skeleton, 256);
  const UvLayoutMeasure measure = measure_snow(limbs.mesh, 256);
  EXPECT_GT(measure.chart_count, 3);
  EXPECT_GT(measure.fill, 0.5);
  EXPECT_EQ(measure.narrow_gutter_texels, 0);
}

TEST(SnowUvs, SqueezesALimbOfOneLongRow) {
  LimbBuilder limbs;
  limbs.add_limb({0, 0, 0}, {0, 0, 100}, 0.1f, 0.05f, 1);
  layout_snow_uvs(limbs.mesh, limbs.skeleton, 256);
  const UvLayoutMeasure measure = measure_snow(limbs.mesh, 256);
  EXPECT_EQ(measure.outside_faces, 0);
  EXPECT_GT(measure.min_face_area, 0.0);
}

TEST(SnowUvs, NoTexelIsSharedAndGuttersAreKeptAtEveryResolution) {
  constexpr unsigned kSeed = 4711;
  SCOPED_TRACE(kSeed);
  LimbBuilder limbs = random_limbs(kSeed, 150);
  for (const int resolution : {200, 256, 1024, 2048, 4096}) {
    layout_snow_uvs(limbs.mesh, limbs.skeleton, resolution);
    const UvLayoutMeasure measure = measure_snow(limbs.mesh, resolution);
    EXPECT_EQ(measure.overlap_texels, 0) << resolution;
    EXPECT_EQ(measure.narrow_gutter_texels, 0) << resolution;
    EXPECT_EQ(measure.narrow_wide_gutter_texels, 0) << resolution;
    EXPECT_EQ(measure.outside_faces, 0) << resolution;
    EXPECT_GT(measure.min_face_area, 0.0) << resolution;
    EXPECT_GE(measure.min_chart_extent, 2.0 - 1e-3) << resolution;
    EXPECT_LT(measure.density_p95 / measure.density_p5, 2.0) << resolution;
    EXPECT_GT(measure.fill, 0.5) << resolution;
    EXPECT_TRUE(limbs.mesh.warnings.empty());
  }
}

TEST(SnowUvs, ALayoutFor1024HoldsAt2048) {
  LimbBuilder limbs = random_limbs(11, 100);
  layout_snow_uvs(limbs.mesh, limbs.skeleton, 1024);
  EXPECT_EQ(measure_snow(limbs.mesh, 2048).overlap_texels, 0);
  EXPECT_EQ(measure_snow(limbs.mesh, 2048).narrow_gutter_texels, 0);
}

TEST(SnowUvs, TooManyChartsForTheMapAreLaidOutForALargerOneWithAWarning) {
  LimbBuilder limbs = random_limbs(5, 150);
  layout_snow_uvs(limbs.mesh, limbs.skeleton, 32);
  ASSERT_EQ(limbs.mesh.warnings.size(), 1u);
  EXPECT_THAT(limbs.mesh.warnings[0], testing::HasSubstr("laid out for 64"));
  EXPECT_EQ(measure_snow(limbs.mesh, 64).overlap_texels, 0);
}

TEST(SnowUvs, RefusesSillyResolutions) {
  LimbBuilder limbs = random_limbs(5, 2);
  EXPECT_THROW(layout_snow_uvs(limbs.mesh, limbs.skeleton, 8), std::invalid_argument);
  EXPECT_THROW(layout_snow_uvs(limbs.mesh, limbs.skeleton, 1 << 20), std::invalid_argument);
}

TEST(SnowUvs, IsTheSameBitByBitEveryTime) {
  LimbBuilder a = random_limbs(9, 60);
  LimbBuilder b = random_limbs(9, 60);
  layout_snow_uvs(a.mesh, a.skeleton, 512);
  layout_snow_uvs(b.mesh, b.skeleton, 512);
  ASSERT_EQ(a.mesh.uv_snow.size(), b.mesh.uv_snow.size());
  EXPECT_EQ(std::memcmp(a.mesh.uv_snow.data(), b.mesh.uv_snow.data(),
                        a.mesh.uv_snow.size() * sizeof(QuadUv)),
            0);
}

TEST(SnowUvs, AnEmptyMeshNeedsNoCharts) {
  TreeMesh mesh;
  layout_snow_uvs(mesh, Skeleton{}, 256);
  EXPECT_TRUE(mesh.uv_snow.empty());
}

TEST(MeasureUvLayout, CountsTexelsThatTwoChartsTouch) {
  UvSurface surface;
  surface.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                      {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  surface.corner_vertex = {0, 1, 2, 3, 4, 5, 6, 7};
  const auto place = [&surface](float x) {
    surface.corner_uv = {{0, 0}, {0.25f, 0},     {0.25f, 0.5f},     {0, 0.5f},
                         {x, 0}, {x + 0.25f, 0}, {x + 0.25f, 0.5f}, {x, 0.5f}};
    return measure_uv_layout(surface, 8);
  };
  UvLayoutMeasure measure = place(0.5f);
  EXPECT_EQ(measure.chart_count, 2);
  EXPECT_EQ(measure.overlap_texels, 0);
  EXPECT_EQ(measure.narrow_gutter_texels, 0);
  EXPECT_DOUBLE_EQ(measure.fill, 0.25);
  EXPECT_DOUBLE_EQ(measure.min_face_area, 8.0);
  EXPECT_DOUBLE_EQ(measure.density_p5, 8.0);
  EXPECT_DOUBLE_EQ(measure.min_chart_extent, 2.0);
  // Side by side: a column of four texels on either side has a neighbour.
  measure = place(0.25f);
  EXPECT_EQ(measure.overlap_texels, 0);
  EXPECT_EQ(measure.narrow_gutter_texels, 8);
  // A tenth of a texel too far to the left.
  measure = place(0.2375f);
  EXPECT_EQ(measure.overlap_texels, 4);
  measure = place(0.9f);
  EXPECT_EQ(measure.outside_faces, 1);
}

TEST(MeasureUvLayout, AMirroredFaceHasNegativeArea) {
  UvSurface surface;
  surface.sides = 3;
  surface.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  surface.corner_vertex = {0, 1, 2};
  surface.corner_uv = {{0, 0}, {0, 0.5f}, {0.5f, 0}};
  EXPECT_DOUBLE_EQ(measure_uv_layout(surface, 8).min_face_area, -8.0);
}

TEST(MeasureUvLayout, AChartThatCoversItselfCounts) {
  UvSurface surface;
  surface.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}};
  surface.corner_vertex = {0, 1, 2, 3, 1, 4, 5, 2};
  surface.corner_uv = {{0, 0},    {0.5f, 0}, {0.5f, 0.5f}, {0, 0.5f},
                       {0.5f, 0}, {0, 0},    {0, 0.5f},    {0.5f, 0.5f}};
  const UvLayoutMeasure measure = measure_uv_layout(surface, 8);
  EXPECT_EQ(measure.chart_count, 1);
  EXPECT_EQ(measure.overlap_texels, 16);
}

}  // namespace
}  // namespace snowbough::tree
