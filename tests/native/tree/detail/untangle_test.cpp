#include "tree/detail/untangle.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <numeric>

#include "tree/crossings/whole.h"

namespace snowbough::tree {
namespace {

constexpr int kPatchSide = 16;
constexpr double kPull = 1.0;

/// A dome of quads over the unit grid, of which the middle rows were pushed over the next ones: so
/// that the surface has three layers there.
struct Pleat {
  std::vector<glm::dvec3> points;
  std::vector<Quad> quads;
  std::vector<int32_t> inside;
  std::vector<double> pull;

  static double height(double x, double y) {
    const double a = x - 0.5 * kPatchSide, b = y - 0.5 * kPatchSide;
    return 4.0 - 0.03 * (a * a + b * b);
  }
  static glm::dvec3 onto(int32_t, const glm::dvec3& p) { return {p.x, p.y, height(p.x, p.y)}; }

  Pleat() {
    for (int i = 0; i <= kPatchSide; ++i) {
      for (int k = 0; k <= kPatchSide; ++k) {
        const bool edge = i == 0 || k == 0 || i == kPatchSide || k == kPatchSide;
        // Faces of the pleat must not lie in one plane with those below, or they would not cross.
        const bool pushed = i >= 6 && i <= 8 && k >= 5 && k <= 11;
        const double x = i + (pushed ? 3.3 : 0.0), y = k + (pushed ? 0.2 : 0.0);
        points.emplace_back(x, y, height(x, y));
        pull.push_back(edge ? 0.0 : kPull);
        if (!edge) inside.push_back(static_cast<int32_t>(points.size()) - 1);
      }
    }
    for (int i = 0; i < kPatchSide; ++i) {
      for (int k = 0; k < kPatchSide; ++k) {
        const int32_t at = i * (kPatchSide + 1) + k;
        quads.push_back({at, at + kPatchSide + 1, at + kPatchSide + 2, at + 1});
      }
    }
  }

  std::vector<int32_t> all_faces() const {
    std::vector<int32_t> all(quads.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }

  int faces_upside_down() const {
    int count = 0;
    for (const Quad& q : quads) {
      count += glm::cross(points[q[2]] - points[q[0]], points[q[3]] - points[q[1]]).z <= 0.0;
    }
    return count;
  }

  void untangle() {
    const Neighbours neighbours(quads, points.size());
    const MovedFaces moved{
        quads, neighbours, inside, all_faces(), std::vector<int32_t>(quads.size(), 0), {-1}};
    MovedCrossings crossings(moved);
    tree::untangle(crossings, pull, onto, {}, points);
  }
};

TEST(Untangle, SpreadsAPleatOutOverTheSurface) {
  Pleat pleat;
  ASSERT_GT(pleat.faces_upside_down(), 5);
  pleat.untangle();
  EXPECT_EQ(pleat.faces_upside_down(), 0);
  EXPECT_TRUE(crossing_quads(pleat.points, pleat.quads, pleat.all_faces()).empty());
  for (const glm::dvec3& p : pleat.points) {
    EXPECT_NEAR(p.z, Pleat::height(p.x, p.y), 1e-9) << "nothing leaves the surface";
  }
}

TEST(Untangle, WhatMayNotMoveStays) {
  Pleat pleat;
  const std::vector<glm::dvec3> before(pleat.points);
  pleat.untangle();
  for (size_t v = 0; v < before.size(); ++v) {
    if (pleat.pull[v] > 0.0) continue;
    EXPECT_EQ(pleat.points[v], before[v]);
  }
}

TEST(Untangle, WhatLiesSmoothlyStays) {
  Pleat pleat;
  pleat.untangle();
  const std::vector<glm::dvec3> before(pleat.points);
  pleat.untangle();
  EXPECT_EQ(pleat.points, before);
}

}  // namespace
}  // namespace snowbough::tree
