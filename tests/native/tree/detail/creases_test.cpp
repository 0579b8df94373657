#include "tree/detail/creases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

constexpr int kRows = 12;

/// One side of a limb along X, one quad wide, with a roof of 60 degrees' turn in its middle.
struct Roof {
  FineMesh fine;
  std::vector<FaceOrigin> origins{FaceOrigin{0, 0, 0, 0, FacePart::kWall}};
  std::vector<int32_t> chains{0};
  std::vector<glm::dvec3> points;

  Roof() {
    for (int row = 0; row <= kRows; ++row) {
      const double x = row - 0.5 * kRows;
      for (const double y : {0.0, 1.0}) {
        points.emplace_back(x, y, -std::abs(x) * std::tan(M_PI / 6.0));
        fine.vertices.push_back({0, y, static_cast<double>(row) / kRows});
      }
    }
    for (int row = 0; row < kRows; ++row) {
      const double low = static_cast<double>(row) / kRows, high = (row + 1.0) / kRows;
      fine.quads.push_back({2 * row, 2 * row + 1, 2 * row + 3, 2 * row + 2});
      fine.face.push_back(0);
      fine.corners.push_back({{{0, low}, {1, low}, {1, high}, {0, high}}});
    }
  }

  double sharpest() const {
    double most = 0.0;
    for (int row = 0; row + 1 < kRows; ++row) {
      const glm::dvec3 a = points[2 * row + 2] - points[2 * row];
      const glm::dvec3 b = points[2 * row + 4] - points[2 * row + 2];
      most = std::max(most, std::acos(glm::dot(glm::normalize(a), glm::normalize(b))));
    }
    return most * 180.0 / M_PI;
  }
};

TEST(Creases, AreSpreadOverTheFacesAround) {
  Roof roof;
  ASSERT_NEAR(roof.sharpest(), 60.0, 1e-6);
  const std::vector<double> farthest(roof.points.size(), 1.0);
  soften_creases(roof.fine, roof.origins, roof.chains, farthest, roof.points);
  EXPECT_LT(roof.sharpest(), 25.0);
}

TEST(Creases, StayWhereVerticesMayNotMove) {
  Roof roof;
  const std::vector<glm::dvec3> before(roof.points);
  const std::vector<double> farthest(roof.points.size(), 0.0);
  soften_creases(roof.fine, roof.origins, roof.chains, farthest, roof.points);
  EXPECT_EQ(roof.points, before);
}

TEST(Creases, NoVertexGoesFartherThanItMay) {
  Roof roof;
  const std::vector<glm::dvec3> before(roof.points);
  const std::vector<double> farthest(roof.points.size(), 0.1);
  soften_creases(roof.fine, roof.origins, roof.chains, farthest, roof.points);
  for (size_t v = 0; v < before.size(); ++v) {
    EXPECT_LE(glm::distance(before[v], roof.points[v]), 0.1 + 1e-9);
  }
  EXPECT_LT(roof.sharpest(), 59.0);
}

}  // namespace
}  // namespace snowbough::tree
