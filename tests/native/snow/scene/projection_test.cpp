#include "snow/scene/projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>

namespace snowbough::snow {
namespace {

FallSettings falling(glm::dvec3 direction, double pixel_size) {
  FallSettings settings;
  settings.direction = glm::normalize(direction);
  settings.pixel_size = pixel_size;
  return settings;
}

TEST(Projection, AxesAreAcrossTheFallAndPointToTheSky) {
  for (const glm::dvec3 direction :
       {glm::dvec3(0, 0, -1), glm::dvec3(1, 0, -1), glm::dvec3(0, 57, -1), glm::dvec3(-3, 1, -2)}) {
    const shared::ProjectionFrame frame = make_projection_frame(falling(direction, 0.5), Bounds{});
    const glm::vec3 x(frame.grid_x);
    const glm::vec3 y(frame.grid_y);
    EXPECT_NEAR(glm::length(x), 2.0f, 1e-5f);
    EXPECT_NEAR(glm::dot(x, y), 0.0f, 1e-5f);
    EXPECT_NEAR(glm::dot(glm::cross(x, y) / 4.0f, glm::vec3(frame.direction)), -1.0f, 1e-5f);
  }
}

TEST(Projection, IsAnchoredAtTheWorldsOriginWhereverTheSceneLies) {
  // The same world point has the same global pixel for scenes with different middles.
  const FallSettings settings = falling({0.2, 0.3, -1.0}, 0.01);
  const glm::dvec3 point(1.234, -0.567, 0.25);
  glm::dvec2 first(0.0);
  for (const double shift : {0.0, 3.0, 700.0}) {
    Bounds bounds;
    bounds.include(point);
    bounds.include(point + glm::dvec3(shift, 2.0 * shift, 0.0));
    const shared::ProjectionFrame frame = make_projection_frame(settings, bounds);
    const glm::dvec3 offset = point - glm::dvec3(glm::vec3(frame.anchor));
    const glm::dvec2 at(glm::dot(offset, glm::dvec3(glm::vec3(frame.grid_x))) +
                            shared::anchor_pixel(frame).x + frame.base.x,
                        glm::dot(offset, glm::dvec3(glm::vec3(frame.grid_y))) +
                            shared::anchor_pixel(frame).y + frame.base.y);
    if (shift == 0.0) {
      first = at;
    }
    EXPECT_NEAR(at.x, first.x, 0.02) << shift;
    EXPECT_NEAR(at.y, first.y, 0.02) << shift;
  }
}

TEST(Projection, JitterFillsThePixelEvenly) {
  int quarters[4] = {0, 0, 0, 0};
  for (uint32_t step = 0; step < 64; ++step) {
    const glm::dvec2 jitter = grid_jitter(5, step);
    ASSERT_GE(jitter.x, 0.0);
    ASSERT_LT(jitter.x, 1.0);
    ++quarters[(jitter.x < 0.5 ? 0 : 1) + (jitter.y < 0.5 ? 0 : 2)];
  }
  for (const int count : quarters) {
    EXPECT_NEAR(count, 16, 2);
  }
}

TEST(Projection, FlutterStaysInItsConeAndBelowTheHorizon) {
  const double cone = 3.0 * std::numbers::pi / 180.0;
  const glm::dvec3 steep = glm::normalize(glm::dvec3(57.0, 0.0, -1.0));
  for (uint32_t step = 0; step < 50; ++step) {
    const glm::dvec3 down = flutter_direction({0, 0, -1}, cone, 1, step);
    EXPECT_LE(std::acos(-down.z), cone + 1e-9);
    EXPECT_LT(flutter_direction(steep, cone, 1, step).z, -0.0087);
  }
}

/// Strips across the cone, as seen from 24 sides, that hold an eighth of it each.
TEST(Projection, FlutterIsEvenFromEverySideInEachRound) {
  const double cone = 3.0 * std::numbers::pi / 180.0;
  const double ends[] = {-0.63470, -0.40397, -0.19764, 0.0, 0.19764, 0.40397, 0.63470, 1.1};
  for (const uint32_t seed : {0u, 1u, 7u}) {
    for (const uint32_t first : {0u, 64u, 640u}) {
      for (int side = 0; side < 24; ++side) {
        const double turn = side * std::numbers::pi / 24.0;
        int counts[8] = {};
        for (uint32_t step = first; step < first + 64; ++step) {
          const glm::dvec3 way = flutter_direction({0, 0, -1}, cone, seed, step);
          const double at = (way.x * std::cos(turn) + way.y * std::sin(turn)) / std::sin(cone);
          int strip = 0;
          while (at >= ends[strip]) ++strip;
          ++counts[strip];
        }
        for (const int count : counts) EXPECT_NEAR(count, 8, 4) << seed << " " << first;
      }
    }
  }
}

TEST(Projection, TilesCoverEveryReceiverOnceAndLeaveOutEmptySky) {
  const std::vector<Tile> tiles = make_tiles({{{0, 0}, {100, 50}}, {{5000, 0}, {5100, 50}}}, 64);
  int64_t pixels = 0;
  for (const Tile& tile : tiles) {
    pixels += int64_t{tile.pixels.size().x} * tile.pixels.size().y;
  }
  EXPECT_EQ(pixels, 2 * 100 * 50);
  EXPECT_THROW(make_tiles({{{0, 0}, {70000, 10}}}, 64), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::snow
