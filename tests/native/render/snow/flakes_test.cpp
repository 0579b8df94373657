#include "render/snow/flakes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace snowbough::render {
namespace {

Snowfall fall(float rate) {
  Snowfall made;
  made.rate = rate;
  return made;
}

TEST(Flakes, asManyAreInTheAirAsLayTheDepth) {
  const Snowfall of = fall(1e-6f);
  const shared::FlakeFall made = flake_fall(of);
  const double box = made.drift.w;
  const double each = 4.18879 * 0.5 * std::pow(static_cast<double>(of.radius), 3.0);
  // Snow per second on level ground: flakes per m3 times speed times snow per flake.
  EXPECT_NEAR(made.counts.y / (box * box * box) * static_cast<double>(of.speed) * each, 1e-6, 1e-9);
}

TEST(Flakes, aSlantingFallOfTheSameDepthNeedsMore) {
  Snowfall slanting = fall(1e-6f);
  slanting.direction = {1.0f, 0.0f, -1.0f};
  EXPECT_NEAR(flake_fall(slanting).counts.y, std::sqrt(2.0) * flake_fall(fall(1e-6f)).counts.y,
              2.0);
}

TEST(Flakes, areNoMoreThanCanBeDrawn) {
  EXPECT_EQ(flake_fall(fall(1.0f)).counts.y, static_cast<uint32_t>(kMaxFlakes));
  EXPECT_EQ(flake_fall(fall(0.0f)).counts.y, 0u);
}

}  // namespace
}  // namespace snowbough::render
