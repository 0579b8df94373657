#include "snow/surface/rims.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "native/snow/surface/shapes.h"

namespace snowbough::snow {
namespace {

/// A level face of a metre and one that goes down from its edge at x = 0 by `degrees`.
SurfaceSource bend(float degrees, bool smooth) {
  const float turn = degrees * std::numbers::pi_v<float> / 180.0f;
  const float x = std::cos(turn), z = -std::sin(turn);
  SurfaceSource source = quads({{-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}, {x, 0, z}, {x, 1, z}},
                               {{0, 1, 2, 3}, {1, 4, 5, 2}});
  if (smooth) source.shading = source.topology.triangles;
  return source;
}

/// Rims of a mesh along x = 0.
size_t rims_at_bend(const SurfaceSource& source) {
  const RimmedMesh mesh(source);
  size_t count = 0;
  for (const Rim& rim : mesh.rims.all()) count += rim.from.x == 0.0f && rim.to.x == 0.0f ? 1 : 0;
  return count;
}

TEST(Rims, ACubeHasFour) {
  const RimmedMesh cube(slab(1.0f, 1.0f));
  ASSERT_EQ(cube.rims.all().size(), 4u);
  for (const Rim& rim : cube.rims.all()) {
    EXPECT_EQ(rim.support, glm::vec3(0, 0, 1));
    EXPECT_EQ(rim.down, glm::vec3(0, 0, -1));
    EXPECT_EQ(rim.out, rim.far_normal);
    EXPECT_EQ(rim.far_extent, 0.05f);
  }
}

TEST(Rims, AClosedBallHasNone) {
  EXPECT_TRUE(RimmedMesh(ball(0.5f, 48, 24)).rims.all().empty());
}

TEST(Rims, AnOpenCardHasFourWithoutAFarFace) {
  const RimmedMesh open(card(1.0f, 1.0f));
  ASSERT_EQ(open.rims.all().size(), 4u);
  for (const Rim& rim : open.rims.all()) EXPECT_EQ(rim.far_normal, glm::vec3(0.0f));
}

TEST(Rims, SmoothOpenEdgesAreSomeOnATarpAndNoneOnALeaf) {
  for (const auto& [size, count] : {std::pair{1.0f, 4}, {0.1f, 0}}) {
    SurfaceSource source = card(size, size);
    source.shading = source.topology.triangles;
    EXPECT_EQ(RimmedMesh(source).rims.all().size(), count) << size;
  }
}

TEST(Rims, TheOpenEdgesOfASmoothShellWithinABodyAreNone) {
  // A card within a box.
  SurfaceSource source = boxes({{{-1, -1, -1}, {1, 1, 1}}});
  const auto first = static_cast<int32_t>(source.positions.size());
  const SurfaceSource shell = card(1.0f, 1.0f);
  source.shading.assign(source.topology.triangles.size(), -1);
  for (const glm::vec3& at : shell.positions) source.positions.push_back(at);
  for (const int32_t corner : shell.topology.triangles) {
    source.topology.triangles.push_back(first + corner);
    source.shading.push_back(corner);
  }
  source.topology.corner_uv.resize(source.topology.triangles.size());
  source.topology.vertex_count = static_cast<int32_t>(source.positions.size());
  EXPECT_EQ(RimmedMesh(source).rims.all().size(), 4u);
}

TEST(Rims, ARidgeIsNone) {
  const SurfaceSource roof =
      quads({{-1, 0, 0}, {-1, 1, 0}, {0, 1, 0.7f}, {0, 0, 0.7f}, {1, 0, 0}, {1, 1, 0}},
            {{0, 3, 2, 1}, {3, 4, 5, 2}});
  EXPECT_EQ(rims_at_bend(roof), 0u);
}

TEST(Rims, AFaceThatTurnsDownFlatEndsAtARim) {
  EXPECT_EQ(rims_at_bend(bend(72.0f, false)), 1u);
}

TEST(Rims, ASlopeIsNone) {
  EXPECT_EQ(rims_at_bend(bend(60.0f, false)), 0u);
}

TEST(Rims, SmoothEdgesBelow75DegreesAreNone) {
  EXPECT_EQ(rims_at_bend(bend(72.0f, true)), 0u);
  EXPECT_EQ(rims_at_bend(bend(78.0f, true)), 1u);
}

TEST(Rims, ABoardsFarFaceEndsWhereTheBoardDoes) {
  const RimmedMesh board(slab(1.0f, 0.02f), 0.3f, 0.12f);
  for (const Rim& rim : board.rims.all()) {
    EXPECT_GE(rim.far_extent, 0.02f);
    EXPECT_LE(rim.far_extent, 0.04f);
  }
}

/// A level face of a metre to x = 0, a strip down at 45 degrees, and an upright face of a metre.
SurfaceSource bevel(float size, float width = 1.0f) {
  return quads({{-1, 0, 0},
                {0, 0, 0},
                {0, width, 0},
                {-1, width, 0},
                {size, 0, -size},
                {size, width, -size},
                {size, 0, -1},
                {size, width, -1}},
               {{0, 1, 2, 3}, {1, 4, 5, 2}, {4, 6, 7, 5}});
}

TEST(Rims, ABevelIsOneWhereItsFacesWouldMeet) {
  const RimmedMesh mesh(bevel(0.02f));
  int found = 0;
  for (const Rim& rim : mesh.rims.all()) {
    if (rim.out.x < 0.9f || rim.far_normal == glm::vec3(0.0f)) continue;
    ++found;
    EXPECT_NEAR(rim.from.x, 0.02f, 1e-3f);
    EXPECT_NEAR(rim.from.z, 0.0f, 1e-6f);
    EXPECT_NEAR(rim.strip_out, 0.02f, 1e-6f);
    EXPECT_NEAR(rim.strip_down, 0.02f, 1e-6f);
    EXPECT_LT(glm::distance(rim.far_normal, glm::vec3(1, 0, 0)), 1e-6f);
  }
  EXPECT_EQ(found, 1);
}

TEST(Rims, ABevelOfAnUnevenStoneIsOne) {
  for (const size_t corner : {1, 2, 4, 5}) {
    for (const float lift : {-2e-3f, 2e-3f}) {
      SurfaceSource stone = bevel(0.02f);
      stone.positions[corner].z += lift;
      const RimmedMesh mesh(stone);
      const auto is_bevel = [](const Rim& rim) {
        return rim.out.x > 0.9f && rim.strip_out > 0.01f;
      };
      EXPECT_TRUE(std::any_of(mesh.rims.all().begin(), mesh.rims.all().end(), is_bevel))
          << corner << " " << lift;
    }
  }
}

TEST(Rims, AStripThatIsTooWideIsNone) {
  const RimmedMesh mesh(bevel(0.05f));
  for (const Rim& rim : mesh.rims.all()) EXPECT_EQ(rim.strip_out, 0.0f);
}

/// Number of rims from which a face goes down, if all edges are shaded smooth, so that open edges
/// do not lengthen them.
int rims_down(SurfaceSource source) {
  source.shading = source.topology.triangles;
  const RimmedMesh mesh(source);
  int count = 0;
  for (const Rim& rim : mesh.rims.all()) count += rim.down != glm::vec3(0.0f) ? 1 : 0;
  return count;
}

TEST(Rims, AStripThatIsHardlyLongerThanWideIsNone) {
  for (const auto& [width, count] : {std::pair{0.08f, 0}, {0.2f, 1}}) {
    EXPECT_EQ(rims_down(bevel(0.02f, width)), count) << width;
  }
}

TEST(Rims, AnEdgeThatIsMuchShorterThanTheSnowIsDeepIsNone) {
  for (const auto& [width, count] : {std::pair{0.02f, 0}, {0.06f, 1}}) {
    EXPECT_EQ(rims_down(bevel(0.001f, width)), count) << width;
  }
}

TEST(Rims, ARoundRailHasNoStrips) {
  constexpr int32_t kSides = 16;
  std::vector<glm::vec3> positions;
  std::vector<std::array<int32_t, 4>> faces;
  for (int32_t i = 0; i < kSides; ++i) {
    const float turn = 6.2831853f * static_cast<float>(i) / kSides;
    for (const float x : {-0.6f, 0.6f})
      positions.emplace_back(x, 0.01f * std::cos(turn), 0.01f * std::sin(turn));
    const int32_t next = (i + 1) % kSides;
    faces.push_back({2 * i, 2 * next, 2 * next + 1, 2 * i + 1});
  }
  const RimmedMesh rail(quads(positions, faces));
  for (const Rim& rim : rail.rims.all()) EXPECT_EQ(rim.far_normal, glm::vec3(0.0f));
}

TEST(RimPosition, OnABevelIsInwardsLessBelow) {
  const RimmedMesh mesh(bevel(0.02f));
  const float even = std::sqrt(0.5f);
  const RimPosition place =
      mesh.rims.place({0.015f, 0.5f, -0.015f}, {even, 0, even}, mesh.rims.parts()[0], 0.001f);
  ASSERT_FALSE(place.is_far_off);
  EXPECT_NEAR(place.below, 0.015f, 1e-4f);
  EXPECT_NEAR(place.distance, 0.005f - 0.015f, 2e-4f);
}

TEST(RimPosition, OnTopOfACubeIsInsideOfTheRim) {
  const RimmedMesh cube(slab(1.0f, 1.0f));
  const RimPosition place =
      cube.rims.place({0.47f, 0.1f, 0.0f}, {0, 0, 1}, cube.rims.parts()[0], 0.01f);
  ASSERT_FALSE(place.is_far_off);
  EXPECT_NEAR(place.distance, 0.03f, 1e-6f);
  EXPECT_LT(glm::distance(place.foot, glm::vec3(0.5f, 0.1f, 0.0f)), 1e-6f);
  EXPECT_EQ(place.level_out, glm::vec3(1, 0, 0));
}

TEST(RimPosition, OnTheSideOfACubeIsBeyondTheRim) {
  const RimmedMesh cube(slab(1.0f, 1.0f));
  const RimPosition place =
      cube.rims.place({0.5f, 0.1f, -0.02f}, {1, 0, 0}, cube.rims.parts()[0], 0.01f);
  ASSERT_FALSE(place.is_far_off);
  EXPECT_NEAR(place.distance, -0.02f, 1e-6f);
}

TEST(RimPosition, AtACornerPointsBetweenBothRims) {
  const RimmedMesh cube(slab(1.0f, 1.0f));
  const RimPosition place =
      cube.rims.place({0.47f, 0.47f, 0.0f}, {0, 0, 1}, cube.rims.parts()[0], 0.03f);
  EXPECT_NEAR(place.out.x, std::sqrt(0.5f), 1e-5f);
  EXPECT_NEAR(place.out.y, std::sqrt(0.5f), 1e-5f);
}

TEST(RimPosition, BeyondTheReachIsFarOff) {
  const RimmedMesh cube(slab(1.0f, 1.0f), 0.3f);
  EXPECT_TRUE(
      cube.rims.place({0.1f, 0.1f, 0.0f}, {0, 0, 1}, cube.rims.parts()[0], 0.01f).is_far_off);
  EXPECT_EQ(cube.rims.distance({0.1f, 0.1f, 0.0f}, {0, 0, 1}, cube.rims.parts()[0], true), 0.3f);
}

TEST(RimPosition, RimsOfOtherPartsSayNothing) {
  const RimmedMesh pair(boxes({{{0, 0, 0}, {1, 1, 1}}, {{1.05f, 0, 0}, {2.05f, 1, 1}}}));
  const RimPosition place =
      pair.rims.place({0.98f, 0.5f, 1.0f}, {0, 0, 1}, pair.rims.parts()[0], 0.05f);
  EXPECT_NEAR(place.level_out.x, 1.0f, 1e-6f);
}

TEST(RimPosition, OfALowerFaceHasNoRimsOfTheStepAbove) {
  // Two levels of one part that a riser joins, as in a stair.
  const SurfaceSource stair = quads({{-1, 0, 0.03f},
                                     {0, 0, 0.03f},
                                     {0, 1, 0.03f},
                                     {-1, 1, 0.03f},
                                     {0, 0, 0},
                                     {0, 1, 0},
                                     {1, 0, 0},
                                     {1, 1, 0}},
                                    {{0, 1, 2, 3}, {1, 4, 5, 2}, {4, 6, 7, 5}});
  const RimmedMesh mesh(stair);
  const RimPosition lower =
      mesh.rims.place({0.1f, 0.5f, 0.0f}, {0, 0, 1}, mesh.rims.parts()[0], 0.01f);
  EXPECT_TRUE(lower.is_far_off);
  const RimPosition upper =
      mesh.rims.place({-0.1f, 0.5f, 0.03f}, {0, 0, 1}, mesh.rims.parts()[0], 0.01f);
  EXPECT_NEAR(upper.distance, 0.1f, 1e-6f);
}

TEST(RimRoom, OfABoardReachesItsMiddle) {
  const RimmedMesh board(boxes({{{0, 0, 0}, {1, 0.1f, 0.5f}}}));
  const RimPosition place =
      board.rims.place({0.5f, 0.0f, 0.5f}, {0, 0, 1}, board.rims.parts()[0], 0.001f);
  EXPECT_NEAR(board.rims.room(place, board.rims.parts()[0], 0.2f), 0.05f, 0.0005f);
  // Steps of the search that are wider than the board do not pass it over.
  EXPECT_NEAR(board.rims.room(place, board.rims.parts()[0], 1.2f), 0.05f, 0.02f);
}

/// A step of 3 cm at x = 0: the upper box is on the left.
RimmedMesh low_step() {
  return RimmedMesh(boxes({{{-1, 0, 0}, {0, 1, 0.53f}}, {{-1, 0, 0}, {1, 1, 0.5f}}}));
}

TEST(RimStep, IsSeenFromItsFoot) {
  const RimmedMesh step = low_step();
  const Rims::Step found = step.rims.step_above({0.05f, 0.5f, 0.5f}, {0, 0, 1}, 0.1f, 0.2f);
  EXPECT_NEAR(found.height, 0.03f, 1e-6f);
  EXPECT_NEAR(found.out, 0.05f, 1e-6f);
  EXPECT_NEAR(found.foot.x, 0.0f, 1e-6f);
  EXPECT_NEAR(found.level_out.x, 1.0f, 1e-6f);
}

TEST(RimStep, IsNegativelyOutBelowTheUpperPiece) {
  const Rims::Step found = low_step().rims.step_above({-0.05f, 0.5f, 0.5f}, {0, 0, 1}, 0.1f, 0.2f);
  EXPECT_NEAR(found.out, -0.05f, 1e-6f);
}

TEST(RimStep, IsNoneOnTopOrFarAwayOrAtAHighWall) {
  const RimmedMesh step = low_step();
  EXPECT_EQ(step.rims.step_above({-0.05f, 0.5f, 0.53f}, {0, 0, 1}, 0.1f, 0.2f).height, 0.0f);
  EXPECT_EQ(step.rims.step_above({0.2f, 0.5f, 0.5f}, {0, 0, 1}, 0.1f, 0.2f).height, 0.0f);
  EXPECT_EQ(step.rims.step_above({0.05f, 0.5f, 0.5f}, {0, 0, 1}, 0.1f, 0.02f).height, 0.0f);
}

TEST(RimOpposite, SeesTheRimAcrossANarrowGap) {
  const RimmedMesh pair(boxes({{{0, 0, 0}, {1, 1, 1}}, {{1.02f, 0, 0}, {2.02f, 1, 1.01f}}}));
  const RimPosition place =
      pair.rims.place({1.0f, 0.5f, 1.0f}, {0, 0, 1}, pair.rims.parts()[0], 0.001f);
  const Rims::Opposite opposite = pair.rims.opposite(place, 0.05f);
  EXPECT_NEAR(opposite.gap, 0.02f, 1e-6f);
  EXPECT_NEAR(opposite.step, 0.01f, 1e-6f);
  EXPECT_GT(opposite.nearness, 0.95f);
}

TEST(RimOpposite, DoesNotSeeBeyondItsReach) {
  const RimmedMesh pair(boxes({{{0, 0, 0}, {1, 1, 1}}, {{1.06f, 0, 0}, {2.06f, 1, 1}}}));
  const RimPosition place =
      pair.rims.place({1.0f, 0.5f, 1.0f}, {0, 0, 1}, pair.rims.parts()[0], 0.001f);
  EXPECT_EQ(pair.rims.opposite(place, 0.05f).nearness, 0.0f);
}

}  // namespace
}  // namespace snowbough::snow
