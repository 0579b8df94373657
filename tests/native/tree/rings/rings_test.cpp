#include "tree/rings/rings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>
#include <random>

#include "tree/obj/parts.h"
#include "tree/rings/squares.h"

namespace snowbough::tree {
namespace {

using testing::ElementsAre;
using testing::FloatNear;

/// How a test tube is built.
struct Tube {
  int sides = 5;
  std::vector<float> radii{0.3f, 0.25f, 0.2f, 0.1f};
  bool tip_vertex = false;
  bool quads = true;
  /// Ends closed by one polygon (1) or a fan round a centre vertex (2).
  int root_cap = 0;
  int tip_cap = 0;
  /// Columns split along a seam: the first is there twice.
  bool seam = false;
};

void add_face(ObjScene& scene, const std::vector<int32_t>& corners) {
  scene.corner_vertex.insert(scene.corner_vertex.end(), corners.begin(), corners.end());
  scene.face_begin.push_back(static_cast<int32_t>(scene.corner_vertex.size()));
}

glm::vec3 axis_point(size_t row) {
  return {0.1f * row * row, 0.0f, static_cast<float>(row)};
}

ObjScene build(const Tube& tube) {
  ObjScene scene;
  scene.runs.push_back({});
  const int columns = tube.sides + (tube.seam ? 1 : 0);
  const size_t rows = tube.radii.size();
  for (size_t row = 0; row < rows; ++row) {
    for (int c = 0; c < columns; ++c) {
      const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(c % tube.sides) /
                          static_cast<float>(tube.sides);
      scene.positions.push_back(axis_point(row) +
                                tube.radii[row] * glm::vec3(std::cos(angle), std::sin(angle), 0));
    }
  }
  const auto at = [&](size_t row, int c) {
    return static_cast<int32_t>(row) * columns + (tube.seam ? c : c % tube.sides);
  };
  for (size_t row = 0; row + 1 < rows; ++row) {
    for (int c = 0; c < tube.sides; ++c) {
      const int32_t a = at(row, c), b = at(row, c + 1), d = at(row + 1, c + 1), e = at(row + 1, c);
      if (tube.quads) {
        add_face(scene, {a, b, d, e});
      } else {
        add_face(scene, {a, b, d});
        add_face(scene, {a, d, e});
      }
    }
  }
  const auto add_cap = [&](size_t row, int cap) {
    if (cap == 1) {
      std::vector<int32_t> corners;
      for (int c = 0; c < tube.sides; ++c) corners.push_back(at(row, c));
      add_face(scene, corners);
    } else if (cap == 2) {
      scene.positions.push_back(axis_point(row));
      const auto centre = static_cast<int32_t>(scene.positions.size()) - 1;
      for (int c = 0; c < tube.sides; ++c) add_face(scene, {at(row, c), at(row, c + 1), centre});
    }
  };
  if (tube.tip_vertex) {
    scene.positions.push_back(axis_point(rows));
    const auto tip = static_cast<int32_t>(scene.positions.size()) - 1;
    for (int c = 0; c < tube.sides; ++c)
      add_face(scene, {at(rows - 1, c), at(rows - 1, c + 1), tip});
  }
  add_cap(0, tube.root_cap);
  add_cap(rows - 1, tube.tip_cap);
  return scene;
}

/// The same surface with its vertices in another order.
ObjScene shuffled(const ObjScene& scene, unsigned seed) {
  std::vector<int32_t> order(scene.positions.size());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(seed);
  std::shuffle(order.begin(), order.end(), random);
  ObjScene mixed = scene;
  for (size_t v = 0; v < order.size(); ++v) mixed.positions[order[v]] = scene.positions[v];
  for (int32_t& v : mixed.corner_vertex) v = order[v];
  return mixed;
}

std::optional<Limb> trace(const ObjScene& scene, NotATube* why = nullptr) {
  const Parts parts = split_parts(scene);
  EXPECT_EQ(parts.count(), 1);
  NotATube reason;
  auto limb = trace_tube(scene, parts.part_faces(0), parts.part_vertices(0), reason);
  if (why != nullptr) *why = reason;
  return limb;
}

void expect_limb(const std::optional<Limb>& limb, const Tube& tube, const std::string& what) {
  ASSERT_TRUE(limb.has_value()) << what;
  ASSERT_EQ(limb->points.size(), tube.radii.size() + (tube.tip_vertex ? 1 : 0)) << what;
  for (size_t i = 0; i < tube.radii.size(); ++i) {
    EXPECT_LT(glm::distance(limb->points[i], axis_point(i)), 1e-5f) << what << " ring " << i;
    EXPECT_NEAR(limb->radii[i], tube.radii[i], 1e-5f) << what << " ring " << i;
    const float sides = static_cast<float>(tube.sides);
    const float area = 0.5f * sides * tube.radii[i] * tube.radii[i] *
                       std::sin(2.0f * std::numbers::pi_v<float> / sides);
    EXPECT_NEAR(limb->areas[i], area, 1e-5f) << what << " ring " << i;
  }
}

TEST(Rings, FollowsTubesOfAnySidesAndEnds) {
  for (const int sides : {3, 4, 5, 6, 8, 13}) {
    for (const bool quads : {true, false}) {
      for (const bool tip : {true, false}) {
        const Tube tube{.sides = sides, .tip_vertex = tip, .quads = quads};
        const std::string what = std::to_string(sides) + " sides, " +
                                 (quads ? "quads" : "triangles") +
                                 (tip ? ", tip vertex" : ", open tip");
        const ObjScene scene = build(tube);
        expect_limb(trace(scene), tube, what);
        expect_limb(trace(shuffled(scene, 5)), tube, what + ", shuffled");
      }
    }
  }
}

TEST(Rings, FollowsClosedTubes) {
  for (const int sides : {3, 4, 6, 8}) {
    for (const int cap : {1, 2}) {
      const Tube tube{.sides = sides, .root_cap = cap, .tip_cap = cap};
      const std::string what = std::to_string(sides) + " sides, cap " + std::to_string(cap);
      expect_limb(trace(build(tube)), tube, what);
      expect_limb(trace(shuffled(build(tube), 3)), tube, what + ", shuffled");
    }
  }
}

TEST(Rings, AnOpenTipWithACappedRoot) {
  const Tube tube{.sides = 6, .root_cap = 2};
  expect_limb(trace(build(tube)), tube, "capped root");
}

TEST(Rings, ClosesATubeThatWasSplitAlongItsSeam) {
  for (const bool quads : {true, false}) {
    const Tube tube{.sides = 6, .quads = quads, .seam = true};
    expect_limb(trace(build(tube)), tube, "seam");
  }
}

TEST(Rings, TheThickerEndIsTheRoot) {
  Tube tube{.radii = {0.1f, 0.2f, 0.3f}};
  const auto limb = trace(build(tube));
  ASSERT_TRUE(limb);
  EXPECT_THAT(limb->radii,
              ElementsAre(FloatNear(0.3f, 1e-5f), FloatNear(0.2f, 1e-5f), FloatNear(0.1f, 1e-5f)));
  EXPECT_FALSE(limb->reversible);
}

TEST(Rings, EqualEndsMayBeSwapped) {
  EXPECT_TRUE(trace(build({.radii = {0.2f, 0.2f, 0.2f}}))->reversible);
}

TEST(Rings, RingsOfNoThicknessStay) {
  const Tube tube{.sides = 3, .radii = {0.1f, 0.0f, 0.0f}, .tip_vertex = true};
  const auto limb = trace(build(tube));
  ASSERT_TRUE(limb);
  EXPECT_EQ(limb->points.size(), 4u);
  EXPECT_EQ(limb->radii[1], 0.0f);
  EXPECT_EQ(limb->areas[2], 0.0f);
}

TEST(Rings, ALeafIsFlat) {
  ObjScene scene;
  scene.runs.push_back({});
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}};
  add_face(scene, {0, 1, 2, 3});
  add_face(scene, {1, 4, 5, 2});
  NotATube why;
  EXPECT_FALSE(trace(scene, &why));
  EXPECT_EQ(why, NotATube::kFlat);
}

TEST(Rings, AGriddedLeafIsNoTube) {
  for (const int size : {4, 5, 6, 7}) {
    ObjScene scene;
    scene.runs.push_back({});
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) scene.positions.emplace_back(x, y, 0.05f * x * y);
    }
    for (int y = 0; y + 1 < size; ++y) {
      for (int x = 0; x + 1 < size; ++x) {
        const int32_t a = y * size + x;
        add_face(scene, {a, a + 1, a + 1 + size, a + size});
      }
    }
    EXPECT_FALSE(trace(scene)) << size;
  }
}

TEST(Rings, AForkedSurfaceIsNoSingleTube) {
  // A square ring that continues in two: a pair of trousers with long legs.
  ObjScene scene;
  scene.runs.push_back({});
  const auto ring = [&](float x, float z, float width) {
    const auto first = static_cast<int32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(),
                           {{x, 0, z}, {x + width, 0, z}, {x + width, 1, z}, {x, 1, z}});
    return first;
  };
  const auto belt = [&](int32_t a, int32_t b) {
    for (int i = 0; i < 4; ++i) add_face(scene, {a + i, a + (i + 1) % 4, b + (i + 1) % 4, b + i});
  };
  const int32_t foot = ring(0, 0, 3);
  const int32_t waist = ring(0, 1, 3);
  belt(foot, waist);
  const int32_t left = ring(0, 2, 1);
  const int32_t right = ring(2, 2, 1);
  add_face(scene, {waist, left, left + 3, waist + 3});
  add_face(scene, {waist + 1, waist + 2, right + 2, right + 1});
  add_face(scene, {waist, waist + 1, right + 1, right, left + 1, left});
  add_face(scene, {waist + 3, left + 3, left + 2, right + 3, right + 2, waist + 2});
  add_face(scene, {left + 1, right, right + 3, left + 2});
  for (int leg = 0; leg < 2; ++leg) {
    int32_t last = leg == 0 ? left : right;
    for (int i = 0; i < 4; ++i) {
      const int32_t next = ring(leg == 0 ? 0.0f : 2.0f, 3.0f + i, 1);
      belt(last, next);
      last = next;
    }
  }
  NotATube why;
  EXPECT_FALSE(trace(scene, &why));
  EXPECT_EQ(why, NotATube::kForks);
}

TEST(Squares, AreaRadiusAndCentre) {
  Limb limb;
  append_ring(std::vector<glm::vec3>{{1, 1, 0}, {3, 1, 0}, {3, 3, 0}, {1, 3, 0}}, limb);
  EXPECT_EQ(limb.points[0], glm::vec3(2, 2, 0));
  EXPECT_FLOAT_EQ(limb.radii[0], std::sqrt(2.0f));
  EXPECT_FLOAT_EQ(limb.areas[0], 4.0f);
}

TEST(Squares, TwoTrianglesMakeOnePlaneWhicheverCornerComesFirst) {
  const glm::vec3 square[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (int turn = 0; turn < 3; ++turn) {
    for (int other = 0; other < 3; ++other) {
      ObjScene scene;
      scene.runs.push_back({});
      scene.positions.assign(square, square + 4);
      std::vector<int32_t> first{0, 1, 2};
      std::vector<int32_t> second{0, 2, 3};
      std::rotate(first.begin(), first.begin() + turn, first.end());
      std::rotate(second.begin(), second.begin() + other, second.end());
      add_face(scene, first);
      add_face(scene, second);
      const auto section = read_cross_section(scene, split_parts(scene), 0);
      ASSERT_TRUE(section);
      Limb limb;
      append_ring(section->corners, limb);
      EXPECT_FLOAT_EQ(limb.areas[0], 1.0f);
    }
  }
}

TEST(Squares, TrianglesWithoutCommonIndicesPairByPosition) {
  ObjScene scene;
  scene.runs.push_back({});
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  add_face(scene, {0, 1, 2});
  add_face(scene, {3, 4, 5});
  std::vector<int32_t> unread;
  const auto sections =
      read_cross_sections(scene, split_parts(scene), std::vector<int32_t>{0, 1}, unread);
  EXPECT_EQ(sections.size(), 1u);
  EXPECT_TRUE(unread.empty());
}

CrossSection square_at(glm::vec3 centre, glm::vec3 u, glm::vec3 v, float half) {
  return {{centre - half * u - half * v, centre + half * u - half * v, centre + half * u + half * v,
           centre - half * u + half * v}};
}

TEST(Squares, ChainsCutWhereANewLimbBegins) {
  std::vector<CrossSection> sections;
  for (int i = 0; i < 6; ++i) {
    sections.push_back(square_at({0, 0, i}, {1, 0, 0}, {0, 1, 0}, 0.2f - 0.03f * i));
  }
  for (int i = 0; i < 4; ++i) {
    sections.push_back(square_at({i, 0, 2}, {0, 1, 0}, {0, 0, 1}, 0.1f - 0.03f * i));
  }
  EXPECT_THAT(chain_cross_sections(sections), ElementsAre(0u, 6u));
  EXPECT_GT(row_share(sections), 0.9);
}

}  // namespace
}  // namespace snowbough::tree
