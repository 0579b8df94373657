#include "snow/surface/cushions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>

namespace snowbough::snow {
namespace {

constexpr float kDepth = 0.012f;

/// `count` flat needles side by side, 2 mm apart, 40 mm long and 0.6 mm wide, each of 20 pieces.
SurfaceMesh spray(int count) {
  SurfaceMesh mesh;
  for (int n = 0; n < count; ++n) {
    const auto first = static_cast<int32_t>(mesh.position.size());
    constexpr int kPieces = 20;
    for (int k = 0; k <= kPieces; ++k) {
      for (const float across : {-0.0003f, 0.0003f}) {
        mesh.position.emplace_back(0.002f * static_cast<float>(k),
                                   0.002f * static_cast<float>(n) + across, 0.0f);
      }
    }
    for (int32_t k = 0; k < kPieces; ++k) {
      const int32_t a = first + 2 * k;
      mesh.triangle.push_back({a, a + 2, a + 3});
      mesh.triangle.push_back({a, a + 3, a + 1});
    }
  }
  return mesh;
}

Cushions cushions_on(const SurfaceMesh& mesh, float thickness, int32_t most_points = 100000) {
  return find_cushions(mesh, mesh.position, std::vector<float>(mesh.position.size(), thickness),
                       kDepth, most_points);
}

TEST(Needles, AreManyThinPieces) {
  EXPECT_TRUE(are_needles(spray(60), kDepth));
}

TEST(Needles, AreNotFewPieces) {
  EXPECT_FALSE(are_needles(spray(5), kDepth));
}

TEST(Needles, AreNotWideBesideTheDepth) {
  EXPECT_FALSE(are_needles(spray(60), 0.0002f));
}

TEST(Cushions, JoinNeedlesInOneClosedBody) {
  const Cushions cushions = cushions_on(spray(60), 0.001f);
  ASSERT_FALSE(cushions.quads.empty());
  std::map<std::pair<int32_t, int32_t>, int> sides;
  for (const auto& quad : cushions.quads) {
    for (size_t k = 0; k < 4; ++k) ++sides[std::minmax(quad[k], quad[(k + 1) % 4])];
  }
  for (const auto& [ends, count] : sides) EXPECT_EQ(count, 2);
}

TEST(Cushions, HangOnTheNeedlesNearThem) {
  const SurfaceMesh mesh = spray(60);
  const Cushions cushions = cushions_on(mesh, 0.001f);
  ASSERT_EQ(cushions.anchor.size(), cushions.offset.size());
  for (size_t p = 0; p < cushions.anchor.size(); ++p) {
    ASSERT_LT(cushions.anchor[p], static_cast<int32_t>(mesh.position.size()));
    EXPECT_LT(glm::length(cushions.offset[p]), kDepth);
  }
}

TEST(Cushions, LeaveALoneNeedleAsItIs) {
  EXPECT_TRUE(cushions_on(spray(1), 0.001f).quads.empty());
}

TEST(Cushions, KeepWithinTheirPoints) {
  const auto all = static_cast<int32_t>(cushions_on(spray(60), 0.001f).anchor.size());
  for (const int32_t most : {all / 2, all / 3}) {
    const auto count = static_cast<int32_t>(cushions_on(spray(60), 0.001f, most).anchor.size());
    EXPECT_LE(count, most);
    EXPECT_GT(count, 0);
  }
}

TEST(Cushions, NeedSnow) {
  EXPECT_TRUE(cushions_on(spray(60), 0.0f).quads.empty());
}

}  // namespace
}  // namespace snowbough::snow
