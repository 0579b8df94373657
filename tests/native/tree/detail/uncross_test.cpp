#include "tree/detail/uncross.h"

#include <gtest/gtest.h>

#include <algorithm>
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

MovedFaces one_chain(const Sheets& sheets, const Neighbours& neighbours, int32_t moving) {
  return {sheets.quads,
          neighbours,
          {moving},
          sheets.all_faces(),
          std::vector<int32_t>(sheets.quads.size(), 0),
          {-1}};
}

TEST(UndoMoves, WhatHasComeToCrossGoesBackUntilItDoesNot) {
  const Sheets sheets;
  std::vector<glm::dvec3> points(sheets.points);
  // A dent of the upper sheet through the lower one.
  const int32_t dented = (kSide + 1) * (kSide + 1) + 4 * (kSide + 1) + 4;
  points[dented].z = -0.6;
  ASSERT_FALSE(crossing_quads(points, sheets.quads, sheets.all_faces()).empty());

  const Neighbours neighbours(sheets.quads, points.size());
  const MovedFaces moved_faces = one_chain(sheets, neighbours, dented);
  MovedCrossings crossings(moved_faces);
  undo_moves(crossings, sheets.points, {}, points);
  EXPECT_TRUE(crossing_quads(points, sheets.quads, sheets.all_faces()).empty());
  EXPECT_GT(points[dented].z, 0.0);
  EXPECT_LT(points[dented].z, 0.5) << "as much of the way as there is room for";
}

TEST(UndoMoves, WhatDoesNotCrossKeepsItsWay) {
  const Sheets sheets;
  std::vector<glm::dvec3> points(sheets.points);
  const int32_t dented = (kSide + 1) * (kSide + 1) + 4 * (kSide + 1) + 4;
  points[dented].z = 0.1;
  const std::vector<glm::dvec3> moved(points);
  const Neighbours neighbours(sheets.quads, points.size());
  const MovedFaces moved_faces = one_chain(sheets, neighbours, dented);
  MovedCrossings crossings(moved_faces);
  undo_moves(crossings, sheets.points, {}, points);
  EXPECT_EQ(points, moved);
}

TEST(MovedCrossings, AreFoundAgainOnlyWhereFacesHaveMoved) {
  const Sheets sheets;
  std::vector<glm::dvec3> points(sheets.points);
  const int32_t dented = (kSide + 1) * (kSide + 1) + 4 * (kSide + 1) + 4;
  const Neighbours neighbours(sheets.quads, points.size());
  const MovedFaces moved_faces = one_chain(sheets, neighbours, dented);
  MovedCrossings crossings(moved_faces);
  EXPECT_TRUE(crossings.find(points, 1).empty());
  points[dented].z = -0.6;
  const MovedCrossings::Pairs pairs = crossing_quads(points, sheets.quads, sheets.all_faces());
  EXPECT_FALSE(pairs.empty());
  EXPECT_EQ(crossings.find(points, 1), pairs);
  EXPECT_EQ(crossings.find(points, 1), pairs);
  points[dented].z = 0.5;
  EXPECT_TRUE(crossings.find(points, 1).empty());
}

TEST(MovedCrossings, LimbsThatDoNotLeaveEachOtherDoNotCount) {
  const Sheets sheets;
  std::vector<glm::dvec3> points(sheets.points);
  const int32_t dented = (kSide + 1) * (kSide + 1) + 4 * (kSide + 1) + 4;
  points[dented].z = -0.6;
  const Neighbours neighbours(sheets.quads, points.size());
  MovedFaces moved_faces = one_chain(sheets, neighbours, dented);
  // The upper sheet is a chain of its own.
  std::fill(moved_faces.chains.begin() + kSide * kSide, moved_faces.chains.end(), 1);
  moved_faces.parents = {-1, -1};
  EXPECT_TRUE(MovedCrossings(moved_faces).find(points, 1).empty());
  moved_faces.parents = {-1, 0};
  EXPECT_FALSE(MovedCrossings(moved_faces).find(points, 1).empty());
}

}  // namespace
}  // namespace snowbough::tree
