#include "tree/detail/uncross.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tree/crossings/whole.h"

namespace snowbough::tree {
namespace {

constexpr int kSide = 8;

/// Two sheets of quads, one above the other.
struct Sheets {
  std::vector<glm::dvec3> points;
  std::vector<Quad> quads;

  Sheets() {
    for (const double z : {0.0, 0.5}) {
      const auto first = static_cast<int32_t>(points.size());
      for (int i = 0; i <= kSide; ++i) {
        for (int k = 0; k <= kSide; ++k) points.emplace_back(i + 0.3 * z, k + 0.2 * z, z);
      }
      for (int i = 0; i < kSide; ++i) {
        for (int k = 0; k < kSide; ++k) {
          const int32_t at = first + i * (kSide + 1) + k;
          quads.push_back({at, at + kSide + 1, at + kSide + 2, at + 1});
        }
      }
    }
  }

  std::vector<int32_t> all_faces() const {
    std::vector<int32_t> all(quads.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
};

TEST(Uncross, WhatHasComeToCrossGoesBackUntilItDoesNot) {
  const Sheets sheets;
  std::vector<glm::dvec3> points(sheets.points);
  // A dent of the upper sheet through the lower one.
  const int32_t dented = (kSide + 1) * (kSide + 1) + 4 * (kSide + 1) + 4;
  points[dented].z = -0.6;
  ASSERT_FALSE(crossing_quads(points, sheets.quads, sheets.all_faces()).empty());

  const Neighbours neighbours(sheets.quads, points.size());
  const ForkFaces fork{sheets.quads, neighbours, {dented}, {sheets.all_faces()}};
  uncross(fork, sheets.points, {}, points);
  EXPECT_TRUE(crossing_quads(points, sheets.quads, sheets.all_faces()).empty());
  EXPECT_GT(points[dented].z, 0.0);
  EXPECT_LT(points[dented].z, 0.5) << "as much of the way as there is room for";
}

TEST(Uncross, WhatDoesNotCrossKeepsItsWay) {
  const Sheets sheets;
  std::vector<glm::dvec3> points(sheets.points);
  const int32_t dented = (kSide + 1) * (kSide + 1) + 4 * (kSide + 1) + 4;
  points[dented].z = 0.1;
  const std::vector<glm::dvec3> moved(points);
  const Neighbours neighbours(sheets.quads, points.size());
  const ForkFaces fork{sheets.quads, neighbours, {dented}, {sheets.all_faces()}};
  uncross(fork, sheets.points, {}, points);
  EXPECT_EQ(points, moved);
}

}  // namespace
}  // namespace snowbough::tree
