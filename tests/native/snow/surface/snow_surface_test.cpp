#include "snow/surface/snow_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>

#include "native/snow/surface/shapes.h"

namespace snowbough::snow {
namespace {

constexpr float kDepth = 0.12f;
/// Without noise and overhang.
constexpr shared::SnowStyle kPlain{0.0f, 0.0f, 0.0f, 0.0f};
constexpr shared::SnowStyle kUsual{1.0f, 1.0f, 1.0f, 1.0f};

SurfacePlan plan_of(glm::vec2 wind = glm::vec2(0.0f)) {
  SurfacePlan plan;
  plan.density = {kDepth, 1.0f, 20000};
  plan.seed = 3;
  plan.wind = wind;
  return plan;
}

/// A surface with a style.
struct StyledSurface {
  SnowSurface surface;
  shared::SnowStyle style;

  std::vector<glm::vec3> points(const SurfaceFrame& frame) const {
    return surface_points(surface, style, frame);
  }
};

StyledSurface surface_on(const SurfaceSource& source, const std::vector<float>& map,
                         const shared::SnowStyle& style = kUsual,
                         glm::vec2 wind = glm::vec2(0.0f)) {
  return {plan_surface(source, map, map, {}, plan_of(wind)), style};
}

SurfaceFrame frame_of(const std::vector<float>& map, float open_depth = kDepth) {
  SurfaceFrame frame;
  frame.height = map.data();
  frame.open_depth = open_depth;
  return frame;
}

/// Highest or lowest coordinate of points.
float most(const std::vector<glm::vec3>& points, int axis, float sign) {
  float found = -std::numeric_limits<float>::infinity();
  for (const glm::vec3& point : points) found = std::max(found, sign * point[axis]);
  return sign * found;
}

TEST(SnowSurface, OnLevelGroundIsAsHighAsTheMap) {
  const SurfaceSource ground = card(4.0f, 4.0f);
  const std::vector<float> map = map_of(ground, {kDepth});
  const StyledSurface surface = surface_on(ground, map, kPlain);
  int inside = 0;
  for (const glm::vec3& point : surface.points(frame_of(map))) {
    if (std::max(std::abs(point.x), std::abs(point.y)) > 1.7f) continue;
    ++inside;
    EXPECT_NEAR(point.z, kDepth, 0.001f);
  }
  EXPECT_GT(inside, 500);
}

TEST(SnowSurface, ReliefWavesAboutTheMap) {
  const SurfaceSource ground = card(4.0f, 4.0f);
  const std::vector<float> map = map_of(ground, {kDepth});
  const StyledSurface surface = surface_on(ground, map, kUsual);
  std::vector<float> height;
  for (const glm::vec3& point : surface.points(frame_of(map))) {
    if (std::max(std::abs(point.x), std::abs(point.y)) < 1.7f) height.push_back(point.z);
  }
  const auto [low, high] = std::minmax_element(height.begin(), height.end());
  EXPECT_LT(*low, 0.95f * kDepth);
  EXPECT_GT(*high, 1.05f * kDepth);
  EXPECT_GT(*low, 0.6f * kDepth);
  EXPECT_LT(*high, 1.4f * kDepth);
}

TEST(SnowSurface, OfABareMapLiesBelowTheReceiver) {
  const SurfaceSource board = slab(1.0f, 0.1f);
  const std::vector<float> bare(kResolution * kResolution, 0.0f);
  const StyledSurface surface = surface_on(board, on_tops(board, kDepth));
  for (const glm::vec3& point : surface.points(frame_of(bare))) {
    EXPECT_LE(point.z, 0.0f);
    EXPECT_LE(std::max(std::abs(point.x), std::abs(point.y)), 0.5f);
  }
}

TEST(SnowSurface, BeforeAnySnowLiesClearlyBelowTheReceiver) {
  const SurfaceSource ground = card(4.0f, 4.0f);
  const std::vector<float> bare(kResolution * kResolution, 0.0f);
  const StyledSurface surface = surface_on(ground, map_of(ground, {kDepth}));
  for (const glm::vec3& point : surface.points(frame_of(bare, 0.0f))) {
    EXPECT_LT(point.z, -0.0004f);
  }
}

TEST(SnowSurface, OfABareMapStaysInsideAThinBoard) {
  const SurfaceSource board = slab(1.0f, 0.002f);
  const std::vector<float> bare(kResolution * kResolution, 0.0f);
  const StyledSurface surface = surface_on(board, on_tops(board, kDepth));
  EXPECT_GT(most(surface.points(frame_of(bare)), 2, -1.0f), -0.002f);
}

TEST(SnowSurface, HangsOverARimThatHasSnow) {
  const SurfaceSource board = slab(1.0f, 0.3f);
  const std::vector<float> map = on_tops(board, kDepth);
  const std::vector<glm::vec3> points = surface_on(board, map).points(frame_of(map));
  for (const int axis : {0, 1}) {
    EXPECT_GT(most(points, axis, 1.0f), 0.5f + 0.1f * kDepth);
    EXPECT_LT(most(points, axis, 1.0f), 0.5f + 0.6f * kDepth);
  }
  EXPECT_LT(most(points, 2, -1.0f), -0.01f * kDepth);
}

TEST(SnowSurface, HangsOverARimWhereTheFloorBehindIsBareBelowABoard) {
  // A strip with snow in front, and a bare board 5 cm above the bare rest.
  constexpr float kFront = -0.5f, kBoard = -0.45f, kBack = 0.5f;
  const SurfaceSource floor = quads({{kFront, -1, 0},
                                     {kBoard, -1, 0},
                                     {kBoard, 1, 0},
                                     {kFront, 1, 0},
                                     {kBack, -1, 0},
                                     {kBack, 1, 0},
                                     {kBoard, -1, 0.05f},
                                     {kBack, -1, 0.05f},
                                     {kBack, 1, 0.05f},
                                     {kBoard, 1, 0.05f}},
                                    {{0, 1, 2, 3}, {1, 4, 5, 2}, {6, 7, 8, 9}});
  const std::vector<float> map = map_of(floor, {kDepth});
  const std::vector<glm::vec3> points = surface_on(floor, map).points(frame_of(map));
  EXPECT_LT(most(points, 0, -1.0f), kFront - 0.15f * kDepth);
}

/// m3 between the faces and the plane z = 0.
float volume_of(const StyledSurface& surface, const std::vector<glm::vec3>& points) {
  double volume = 0.0;
  const SurfaceFaces& faces = surface.surface.faces;
  for (size_t f = 0; f + 1 < faces.begin.size(); ++f) {
    for (int32_t k = faces.begin[f] + 1; k + 1 < faces.begin[f + 1]; ++k) {
      const glm::vec3& a = points[faces.corner[faces.begin[f]]];
      const glm::vec3& b = points[faces.corner[k]];
      const glm::vec3& c = points[faces.corner[k + 1]];
      volume += glm::cross(b - a, c - a).z * (a.z + b.z + c.z) / 6.0;
    }
  }
  return static_cast<float>(volume);
}

TEST(SnowSurface, OnANarrowTopHoldsWhatTheMapHolds) {
  // The shape after repose on a post: a pyramid.
  constexpr float kSide = 0.1f, kTop = 0.06f;
  const SurfaceSource post = slab(kSide, 0.5f);
  std::vector<float> map = on_tops(post, kTop);
  const float cell = kResolution / 3.0f;
  for (int32_t y = 0; y < kResolution; ++y) {
    for (int32_t x = 0; x < kResolution; ++x) {
      const glm::vec2 place = (glm::vec2(x, y) + 0.5f) / cell * 2.0f - 1.0f;
      map[static_cast<size_t>(y * kResolution + x)] *=
          std::max(1.0f - std::max(std::abs(place.x), std::abs(place.y)) * 1.23f, 0.0f);
    }
  }
  const StyledSurface surface = surface_on(post, map);
  EXPECT_NEAR(volume_of(surface, surface.points(frame_of(map))) / (kTop * kSide * kSide / 3.0f),
              1.0f, 0.2f);
}

TEST(SweptHeight, OnACylinderHoldsAsMuchAsOnAPlane) {
  constexpr float kRadius = 0.01f, kHeight = 0.012f;
  shared::SnowPoint point{};
  point.convexity = 1.0f / kRadius;
  const float outer = kRadius + shared::swept_height(point, kHeight);
  EXPECT_NEAR(outer * outer - kRadius * kRadius, 2.0f * kRadius * kHeight, 1e-7f);
  point.convexity = 0.0f;
  EXPECT_EQ(shared::swept_height(point, kHeight), kHeight);
}

TEST(SnowSurface, HasNoHemOnABareRim) {
  // Snow on the left half only.
  const SurfaceSource board = slab(4.0f, 0.3f);
  std::vector<float> map = on_tops(board, kDepth);
  const int32_t half = kResolution / cells_across(6) / 2;
  for (size_t i = 0; i < map.size(); ++i) {
    if (static_cast<int32_t>(i % kResolution) > half) map[i] = 0.0f;
  }
  const std::vector<glm::vec3> points = surface_on(board, map).points(frame_of(map));
  EXPECT_LE(most(points, 0, 1.0f), 2.0f);
  EXPECT_LT(most(points, 0, -1.0f), -2.0f - 0.1f * kDepth);
}

TEST(SnowSurface, WithoutOverhangHasAnUprightHem) {
  const SurfaceSource board = slab(1.0f, 0.3f);
  const std::vector<float> map = on_tops(board, kDepth);
  for (const glm::vec3& point : surface_on(board, map, kPlain).points(frame_of(map))) {
    EXPECT_TRUE(std::abs(point.y) > 0.3f || std::abs(point.x) < 0.501f) << point.x;
  }
}

TEST(SnowSurface, HemVariationMakesTheHemUneven) {
  const SurfaceSource board = slab(1.0f, 0.3f);
  const std::vector<float> map = on_tops(board, kDepth);
  const auto spread = [&](float variation) {
    const std::vector<glm::vec3> points =
        surface_on(board, map, {1.0f, variation, 0.0f, 0.0f}).points(frame_of(map));
    // The farthest point in each tenth of the rim's middle.
    std::vector<float> out(10, 0.0f);
    for (const glm::vec3& point : points) {
      const auto tenth = static_cast<int>(std::floor((point.y + 0.3f) / 0.06f));
      if (tenth >= 0 && tenth < 10)
        out[static_cast<size_t>(tenth)] = std::max(out[static_cast<size_t>(tenth)], point.x);
    }
    return *std::max_element(out.begin(), out.end()) - *std::min_element(out.begin(), out.end());
  };
  EXPECT_LT(spread(0.0f), 0.02f * kDepth);
  EXPECT_GT(spread(1.0f), 0.05f * kDepth);
}

/// Height of the highest point near x = 0.02 on the lower side of a step of `height` at x = 0.
float at_the_foot(float height) {
  const SurfaceSource stair = quads({{-1, -1, height},
                                     {0, -1, height},
                                     {0, 1, height},
                                     {-1, 1, height},
                                     {0, -1, 0},
                                     {0, 1, 0},
                                     {1, -1, 0},
                                     {1, 1, 0}},
                                    {{0, 1, 2, 3}, {1, 4, 5, 2}, {4, 6, 7, 5}});
  const std::vector<float> map = map_of(stair, {kDepth, 0.0f, kDepth});
  float highest = 0.0f;
  for (const glm::vec3& point : surface_on(stair, map, kPlain).points(frame_of(map))) {
    if (std::abs(point.y) < 0.5f && std::abs(point.x) < 0.02f) highest = std::max(highest, point.z);
  }
  return highest;
}

TEST(SnowSurface, AFrontIsAsHighAsItStandsAboveTheSnowBeyond) {
  // Of 3 cm, 35 % sink; a front that stands free keeps its height.
  EXPECT_NEAR(at_the_foot(0.03f), kDepth + 0.65f * 0.03f, 0.006f);
  EXPECT_NEAR(at_the_foot(1.0f), 1.0f + kDepth, 0.04f);
}

/// Height of the drawn top every centimetre across four boards whose upper sides are 25 cm wide,
/// and lie `step` above each other and `gap` apart; each reaches below the next one by `under`.
std::vector<float> top_of_boards(float step, float gap, float under) {
  std::vector<Box> all;
  for (int k = 0; k < 4; ++k) {
    const float x = 0.25f * static_cast<float>(k), z = -step * static_cast<float>(k);
    all.push_back({{x + 0.5f * gap - under, -0.5f, z - 0.02f}, {x + 0.25f - 0.5f * gap, 0.5f, z}});
  }
  const SurfaceSource stair = boxes(all);
  const std::vector<float> map = on_tops(stair, kDepth);
  const StyledSurface surface = surface_on(stair, map, {0.0f, 0.0f, 1.0f, 0.0f});
  const std::vector<glm::vec3> points = surface.points(frame_of(map));
  const SurfaceFaces& faces = surface.surface.faces;
  std::vector<std::array<int32_t, 3>> triangles;
  for (size_t f = 0; f + 1 < faces.begin.size(); ++f) {
    for (int32_t k = faces.begin[f] + 1; k + 1 < faces.begin[f + 1]; ++k)
      triangles.push_back({faces.corner[faces.begin[f]], faces.corner[k], faces.corner[k + 1]});
  }
  const base::TriangleTree tree(points, triangles, {0, static_cast<int32_t>(triangles.size())});
  std::vector<float> top;
  for (float x = 0.3f; x < 0.7f; x += 0.01f) {
    const auto hit = tree.first_along(0, {x, 0.013, 1.0}, {0.0, 0.0, -1.0}, 1e-5);
    top.push_back(1.0f - static_cast<float>(hit.distance));
  }
  return top;
}

/// Greatest fall of the top within a centimetre.
float steepest_fall(const std::vector<float>& top) {
  float most = 0.0f;
  for (size_t i = 1; i < top.size(); ++i) most = std::max(most, std::abs(top[i - 1] - top[i]));
  return most;
}

TEST(SnowSurface, IsOneBlanketOverStepsMuchLowerThanItsDepth) {
  EXPECT_LT(steepest_fall(top_of_boards(0.02f, 0.0f, 0.05f)), 0.005f);
}

TEST(SnowSurface, IsOneBlanketOverNarrowGaps) {
  EXPECT_LT(steepest_fall(top_of_boards(0.0f, 0.006f, 0.0f)), 0.003f);
}

TEST(SnowSurface, KeepsStepsThatStandOutOfIt) {
  EXPECT_GT(steepest_fall(top_of_boards(0.1f, 0.0f, 0.05f)), 0.03f);
}

TEST(SnowSurface, LeansFurtherOnTheLeeSide) {
  const SurfaceSource board = slab(1.0f, 0.3f);
  const std::vector<float> map = on_tops(board, kDepth);
  const std::vector<glm::vec3> calm = surface_on(board, map).points(frame_of(map));
  const std::vector<glm::vec3> windy =
      surface_on(board, map, kUsual, {0.8f, 0.0f}).points(frame_of(map));
  EXPECT_GT(most(windy, 0, 1.0f), most(calm, 0, 1.0f) + 0.1f * kDepth);
  EXPECT_NEAR(most(windy, 0, -1.0f), most(calm, 0, -1.0f), 1e-4f);
}

/// Gap in metres between the snow on two boards 2 cm apart, away from their ends: negative where
/// the two sides overlap.
float gap_between_boards(float bridging) {
  const SurfaceSource boards = boxes(
      {{{-1.0f, 0.0f, -0.3f}, {-0.01f, 1.0f, 0.0f}}, {{0.01f, 0.0f, -0.3f}, {1.0f, 1.0f, 0.0f}}});
  const std::vector<float> bare = on_tops(boards, 0.0f), map = on_tops(boards, kDepth);
  StyledSurface surface = surface_on(boards, map, kPlain);
  // Bare points stay on their own board.
  const std::vector<glm::vec3> places = surface.points(frame_of(bare));
  surface.style = {0.0f, 0.0f, bridging, 0.0f};
  const std::vector<glm::vec3> points = surface.points(frame_of(map));
  float left = -1.0f, right = 1.0f;
  for (size_t p = 0; p < points.size(); ++p) {
    if (points[p].y < 0.3f || points[p].y > 0.7f) continue;
    if (places[p].x < 0.0f) {
      left = std::max(left, points[p].x);
    } else {
      right = std::min(right, points[p].x);
    }
  }
  return right - left;
}

TEST(SnowSurface, BridgesANarrowGap) {
  EXPECT_LT(gap_between_boards(1.0f), 0.002f);
}

TEST(SnowSurface, LeavesAGapOpenWithoutBridging) {
  EXPECT_GT(gap_between_boards(0.0f), 0.018f);
}

TEST(SnowSurface, HangsBelowACardWithSnowOnItsBack) {
  const SurfaceSource sheet = card(1.0f, 1.0f);
  const std::vector<float> map = map_of(sheet, {-kDepth});
  const std::vector<glm::vec3> points = surface_on(sheet, map).points(frame_of(map));
  ASSERT_FALSE(points.empty());
  EXPECT_LT(most(points, 2, -1.0f), -0.03f);
  EXPECT_LT(most(points, 2, 1.0f), 0.005f);
}

TEST(SnowSurfaceDeathTest, GivesTheSamePointsOnOneThread) {
  const SurfaceSource board = slab(1.0f, 0.3f);
  const std::vector<float> map = on_tops(board, kDepth);
  const std::vector<glm::vec3> points = surface_on(board, map).points(frame_of(map));
  // A forked process has none of the pool's threads.
  EXPECT_EXIT(std::_Exit(surface_on(board, map).points(frame_of(map)) == points ? 0 : 1),
              testing::ExitedWithCode(0), "");
}

TEST(SnowSurface, FollowsPositionsThatTurnAsAWhole) {
  const SurfaceSource board = slab(1.0f, 0.3f);
  const std::vector<float> map = on_tops(board, kDepth);
  const StyledSurface surface = surface_on(board, map);
  const glm::mat4 turn =
      glm::rotate(glm::translate(glm::mat4(1.0f), {0.5f, -0.2f, 0.1f}), 0.7f, glm::vec3(0, 0, 1));
  std::vector<glm::vec3> positions;
  for (const glm::vec3& position : board.positions)
    positions.emplace_back(turn * glm::vec4(position, 1.0f));
  SurfaceFrame moved = frame_of(map);
  moved.positions = positions.data();
  const std::vector<glm::vec3> expected = surface.points(frame_of(map)),
                               found = surface.points(moved);
  for (size_t p = 0; p < expected.size(); ++p) {
    EXPECT_LT(glm::distance(found[p], glm::vec3(turn * glm::vec4(expected[p], 1.0f))), 1e-5f);
  }
}

/// Processor time in seconds for a surface on triangles around the x axis, `apart` from each other
/// along y.
double time_of_blades(int count, float apart) {
  SurfaceSource source;
  for (int i = 0; i < count; ++i) {
    const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / count;
    const auto first = static_cast<int32_t>(source.positions.size());
    const float y = apart * static_cast<float>(i);
    source.positions.insert(
        source.positions.end(),
        {{-0.5f, y, 0}, {0.5f, y, 0}, {0, y + 0.5f * std::cos(angle), 0.5f * std::sin(angle)}});
    source.topology.triangles.insert(source.topology.triangles.end(),
                                     {first, first + 1, first + 2});
    source.topology.corner_uv.insert(source.topology.corner_uv.end(),
                                     {{0.1f, 0.1f}, {0.9f, 0.1f}, {0.1f, 0.9f}});
  }
  source.topology.vertex_count = 3 * count;
  source.topology.resolution = kResolution;
  const std::vector<float> map(static_cast<size_t>(kResolution) * kResolution, 0.05f);
  SurfacePlan plan = plan_of();
  plan.density = {0.1f, 3.0f, 200000};
  const std::clock_t begun = std::clock();
  plan_surface(source, map, map, {}, plan);
  return static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
}

TEST(SnowSurface, TakesAboutAsLongForBladesAtOneAxleAsForBladesApart) {
  // It took seven times as long, and grew with the square of their number.
  const double apart = time_of_blades(100, 3.0f);
  EXPECT_LT(time_of_blades(100, 0.0f), 2.5 * apart);
}

TEST(SnowSurfaceFaces, OfAReceiverWithoutFacesAreNone) {
  SurfaceSource nothing;
  nothing.topology.resolution = kResolution;
  EXPECT_EQ(surface_on(nothing, std::vector<float>(kResolution * kResolution, kDepth))
                .surface.point_count(),
            0u);
}

}  // namespace
}  // namespace snowbough::snow
