#include "tree/leaves/leaf_uvs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/chart_measure.h"

namespace snowbough::tree {
namespace {

/// Adds a polygon of its own vertices to a leaf.
void add_face(Foliage& foliage, int32_t leaf, const std::vector<glm::vec3>& corners) {
  if (foliage.face_begin.empty()) {
    foliage.face_begin.push_back(0);
  }
  for (const glm::vec3& corner : corners) {
    foliage.corner_vertex.push_back(static_cast<int32_t>(foliage.vertices.size()));
    foliage.vertices.push_back(corner);
  }
  foliage.face_begin.push_back(static_cast<int32_t>(foliage.corner_vertex.size()));
  foliage.face_leaf.push_back(leaf);
}

/// Adds a polygon over vertices that are already there.
void add_indexed_face(Foliage& foliage, int32_t leaf, const std::vector<int32_t>& corners) {
  if (foliage.face_begin.empty()) {
    foliage.face_begin.push_back(0);
  }
  foliage.corner_vertex.insert(foliage.corner_vertex.end(), corners.begin(), corners.end());
  foliage.face_begin.push_back(static_cast<int32_t>(foliage.corner_vertex.size()));
  foliage.face_leaf.push_back(leaf);
}

UvLayoutMeasure measure(const Foliage& foliage, const LeafUvs& layout, int sides) {
  UvSurface surface{sides, foliage.vertices, foliage.corner_vertex, layout.corner_uv};
  return measure_uv_layout(surface, layout.resolution);
}

Foliage random_quads(int count) {
  Foliage foliage;
  std::mt19937 random(77);
  const auto unit = [&random] { return static_cast<float>(random()) / 4294967296.0f - 0.5f; };
  for (int leaf = 0; leaf < count; ++leaf) {
    const glm::vec3 base(unit(), unit(), unit());
    const glm::vec3 a(0.1f * unit(), 0.1f * unit(), 0.1f * unit());
    const glm::vec3 b(0.1f * unit(), 0.1f * unit(), 0.1f * unit());
    add_face(foliage, leaf, {base, base + a, base + a + b, base + b});
  }
  return foliage;
}

TEST(LeafUvs, EveryLeafGetsItsOwnTexels) {
  const Foliage foliage = random_quads(300);
  for (const int resolution : {64, 300, 1024}) {
    const LeafUvs layout = layout_leaf_uvs(foliage, resolution);
    EXPECT_EQ(layout.resolution, resolution);
    EXPECT_TRUE(layout.fits(resolution));
    const UvLayoutMeasure result = measure(foliage, layout, 4);
    EXPECT_EQ(result.chart_count, 300);
    EXPECT_EQ(result.overlap_texels, 0);
    EXPECT_EQ(result.narrow_gutter_texels, 0);
    EXPECT_EQ(result.narrow_wide_gutter_texels, 0);
    EXPECT_EQ(result.outside_faces, 0);
    EXPECT_GT(result.min_face_area, 0.0);
    EXPECT_GE(result.min_chart_extent, 2.0 - 1e-3);
  }
}

TEST(LeafUvs, AFlatLeafKeepsItsShapeAndScale) {
  Foliage foliage;
  add_face(foliage, 0, {{0, 0, 0}, {0.3f, 0, 0}, {0.3f, 0, 0.1f}, {0, 0, 0.1f}});
  add_face(foliage, 1, {{0, 1, 0}, {0.2f, 1, 0}, {0.2f, 1.2f, 0}, {0, 1.2f, 0}});
  const LeafUvs layout = layout_leaf_uvs(foliage, 256);
  const auto length = [&layout](int a, int b) {
    return 256.0 * std::hypot(layout.corner_uv[a].x - layout.corner_uv[b].x,
                              layout.corner_uv[a].y - layout.corner_uv[b].y);
  };
  EXPECT_NEAR(length(0, 1) / layout.scale, 0.3, 1e-4);
  EXPECT_NEAR(length(1, 2) / layout.scale, 0.1, 1e-4);
  EXPECT_NEAR(length(4, 5) / layout.scale, 0.2, 1e-4);
}

TEST(LeafUvs, ABentLeafOfTwoQuadsIsOneChart) {
  Foliage foliage;
  foliage.vertices = {{0, 0, 0}, {1, 0, 0.2f}, {1, 2, 0.2f}, {0, 2, 0}, {2, 0, 0}, {2, 2, 0}};
  add_indexed_face(foliage, 0, {0, 1, 2, 3});
  add_indexed_face(foliage, 0, {1, 4, 5, 2});
  const LeafUvs layout = layout_leaf_uvs(foliage, 64);
  EXPECT_EQ(layout.chart_count, 1);
  EXPECT_EQ(measure(foliage, layout, 4).overlap_texels, 0);
}

TEST(LeafUvs, CrossedPlanesAndFoldedIslandsAreTakenApart) {
  Foliage crossed;
  add_face(crossed, 0, {{-1, 0, 0}, {1, 0, 0}, {1, 0, 2}, {-1, 0, 2}});
  add_face(crossed, 0, {{0, -1, 0}, {0, 1, 0}, {0, 1, 2}, {0, -1, 2}});
  EXPECT_EQ(layout_leaf_uvs(crossed, 64).chart_count, 2);

  // A needle: a tube of three sides.
  Foliage needle;
  needle.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5f, 1, 0}, {0, 0, 9}, {1, 0, 9}, {0.5f, 1, 9}};
  add_indexed_face(needle, 0, {0, 1, 4, 3});
  add_indexed_face(needle, 0, {1, 2, 5, 4});
  add_indexed_face(needle, 0, {2, 0, 3, 5});
  const LeafUvs layout = layout_leaf_uvs(needle, 64);
  EXPECT_EQ(layout.chart_count, 3);
  EXPECT_EQ(measure(needle, layout, 4).overlap_texels, 0);
  EXPECT_GT(measure(needle, layout, 4).min_face_area, 0.0);
}

/// A strip of quads around the z axis, a tenth of a turn each, that rises by `rise` a turn.
Foliage winding_strip(int quads, float rise) {
  Foliage foliage;
  for (int i = 0; i <= quads; ++i) {
    const float angle = 0.1f * 6.2831853f * static_cast<float>(i);
    for (const float radius : {1.0f, 2.0f}) {
      foliage.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                                    0.1f * rise * static_cast<float>(i));
    }
  }
  for (int32_t i = 0; i < quads; ++i) {
    add_indexed_face(foliage, 0, {2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2});
  }
  return foliage;
}

TEST(LeafUvs, AHookedLeafIsOneChart) {
  const Foliage foliage = winding_strip(7, 0.0f);
  const LeafUvs layout = layout_leaf_uvs(foliage, 64);
  EXPECT_EQ(layout.chart_count, 1);
  EXPECT_EQ(measure(foliage, layout, 4).overlap_texels, 0);
}

TEST(LeafUvs, ALeafThatWindsAroundOverItselfIsTakenApart) {
  const Foliage foliage = winding_strip(13, 0.2f);
  const LeafUvs layout = layout_leaf_uvs(foliage, 64);
  EXPECT_EQ(layout.chart_count, 13);
  EXPECT_EQ(measure(foliage, layout, 4).overlap_texels, 0);
}

TEST(LeafUvs, TheFacesOfALeafMayLieApart) {
  Foliage foliage;
  foliage.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}, {2, 0, 0}, {2, 2, 0}};
  add_indexed_face(foliage, 1, {0, 1, 2, 3});
  add_face(foliage, 0, {{5, 0, 0}, {6, 0, 0}, {6, 2, 0}, {5, 2, 0}});
  add_indexed_face(foliage, 1, {1, 4, 5, 2});
  const LeafUvs layout = layout_leaf_uvs(foliage, 64);
  EXPECT_EQ(layout.chart_count, 2);
  EXPECT_EQ(measure(foliage, layout, 4).overlap_texels, 0);
}

TEST(LeafUvs, LeavesNumberedAlikeMayFoldDifferently) {
  // Two quads each: flat, shut like a book, flat.
  Foliage foliage;
  for (int32_t leaf = 0; leaf < 3; ++leaf) {
    const auto first = static_cast<int32_t>(foliage.vertices.size());
    const float x = leaf == 1 ? 0.1f : 2.0f;
    const float z = leaf == 1 ? 0.9f : 0.0f;
    for (const glm::vec3& p : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(1, 2, 0),
                               glm::vec3(0, 2, 0), glm::vec3(x, 0, z), glm::vec3(x, 2, z)}) {
      foliage.vertices.push_back(p);
    }
    add_indexed_face(foliage, leaf, {first, first + 1, first + 2, first + 3});
    add_indexed_face(foliage, leaf, {first + 1, first + 4, first + 5, first + 2});
  }
  const LeafUvs layout = layout_leaf_uvs(foliage, 64);
  EXPECT_EQ(layout.chart_count, 4);
  EXPECT_EQ(measure(foliage, layout, 4).overlap_texels, 0);
}

TEST(LeafUvs, TheScaleIsNearlyTheLargest) {
  // Seven squares of a metre in a row: at 7 texels each they take 61 with their gutters of two,
  // of 62.
  Foliage foliage;
  for (int32_t leaf = 0; leaf < 49; ++leaf) {
    add_face(foliage, leaf, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  }
  const LeafUvs layout = layout_leaf_uvs(foliage, 64);
  EXPECT_NEAR(layout.scale, 7.0, 0.01);
  EXPECT_LE(layout.scale, 7.0);
}

TEST(LeafUvs, FacesWithoutAreaStillGetAPlace) {
  Foliage foliage;
  add_face(foliage, 0, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  add_face(foliage, 1, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  add_face(foliage, 2, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const LeafUvs layout = layout_leaf_uvs(foliage, 64);
  const UvLayoutMeasure result = measure(foliage, layout, 3);
  EXPECT_GT(result.min_face_area, 0.5);
  EXPECT_EQ(result.overlap_texels, 0);
}

TEST(LeafUvs, TooManyLeavesNameTheResolutionTheyNeed) {
  const Foliage foliage = random_quads(300);
  // 300 charts of two texels and a gutter take 2700 texels: more than 32 squared, less than 64.
  const LeafUvs layout = layout_leaf_uvs(foliage, 32);
  EXPECT_EQ(layout.resolution, 64);
  EXPECT_FALSE(layout.fits(32));
  EXPECT_EQ(measure(foliage, layout, 4).overlap_texels, 0);
}

TEST(LeafUvs, DoNotDependOnTheNumberOfThreads) {
  const Foliage foliage = random_quads(3000);
  EXPECT_EQ(layout_leaf_uvs(foliage, 512, {1, {}}).corner_uv,
            layout_leaf_uvs(foliage, 512, {5, {}}).corner_uv);
}

TEST(LeafUvs, StopWhenAsked) {
  const Foliage foliage = random_quads(3000);
  for (const float until : {0.1f, 0.5f, 0.8f}) {
    const base::Execution stop{0, [until](float share) { return share < until; }};
    EXPECT_THROW(layout_leaf_uvs(foliage, 512, stop), base::Cancelled);
  }
}

TEST(LeafUvs, NoFoliageNeedsNoCharts) {
  const LeafUvs layout = layout_leaf_uvs(Foliage{}, 64);
  EXPECT_TRUE(layout.corner_uv.empty());
  EXPECT_EQ(layout.chart_count, 0);
}

TEST(LeafUvs, RefusesContradictoryArrays) {
  Foliage foliage = random_quads(2);
  foliage.face_leaf.pop_back();
  EXPECT_THROW(layout_leaf_uvs(foliage, 64), std::invalid_argument);
  EXPECT_THROW(layout_leaf_uvs(random_quads(2), 4), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::tree
