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
  /// Ends closed by one polygon (1) or a fan round a centre vertex (2).
  int root_cap = 0;
  int tip_cap = 0;
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
  const size_t rows = tube.radii.size();
  for (size_t row = 0; row < rows; ++row) {
    for (int c = 0; c < tube.sides; ++c) {
      const float angle =
          2.0f * std::numbers::pi_v<float> * static_cast<float>(c) / static_cast<float>(tube.sides);
      scene.positions.push_back(axis_point(row) +
                                tube.radii[row] * glm::vec3(std::cos(angle), std::sin(angle), 0));
    }
  }
  const auto at = [&](size_t row, int c) {
    return static_cast<int32_t>(row) * tube.sides + c % tube.sides;
  };
  for (size_t row = 0; row + 1 < rows; ++row) {
    for (int c = 0; c < tube.sides; ++c) {
      const int32_t a = at(row, c), b = at(row, c + 1), d = at(row + 1, c + 1), e = at(row + 1, c);
      add_face(scene, {a, b, d, e});
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

std::optional<Limb> trace(const ObjScene& scene) {
  const Parts parts = split_parts(scene);
  EXPECT_EQ(parts.count(), 1);
  NotATube reason;
  return trace_tube(scene, parts.part_faces(0), parts.part_vertices(0), reason);
}

void expect_limb(const std::optional<Limb>& limb, const Tube& tube, const std::string& what) {
  ASSERT_TRUE(limb.has_value()) << what;
  ASSERT_EQ(limb->points.size(), tube.radii.size()) << what;
  for (size_t i = 0; i < tube.radii.size(); ++i) {
    EXPECT_LT(glm::distance(limb->points[i], axis_point(i)), 1e-5f) << what << " ring " << i;
    EXPECT_NEAR(limb->radii[i], tube.radii[i], 1e-5f) << what << " ring " << i;
    const float sides = static_cast<float>(tube.sides);
    const float area = 0.5f * sides * tube.radii[i] * tube.radii[i] *
                       std::sin(2.0f * std::numbers::pi_v<float> / sides);
    EXPECT_NEAR(limb->areas[i], area, 1e-5f) << what << " ring " << i;
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

TEST(Squares, AreaRadiusAndCentre) {
  Limb limb;
  append_ring(std::vector<glm::vec3>{{1, 1, 0}, {3, 1, 0}, {3, 3, 0}, {1, 3, 0}}, limb);
  EXPECT_EQ(limb.points[0], glm::vec3(2, 2, 0));
  EXPECT_FLOAT_EQ(limb.radii[0], std::sqrt(2.0f));
  EXPECT_FLOAT_EQ(limb.areas[0], 4.0f);
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
