// The limits of a row's links are those of the shared arithmetic, to the bit.
#include "snow/movement/repose/link_limits.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/tile_ground.h"

namespace snowbough::snow {
namespace {

constexpr ReposeLimits kLimits{.slope = 1.3f, .cohesion = 0.0f};

/// A row of cells whose slope grows along it, each linked with the next.
struct SteepeningRow {
  std::unique_ptr<BareWindow> bare = std::make_unique<BareWindow>();
  std::array<uint8_t, kReposeBlock> forward{};

  explicit SteepeningRow(float steepest) {
    for (int32_t i = 0; i < kReposeBlock; ++i) {
      const size_t at = TileWindow::at(i, 0);
      const float part = static_cast<float>(i) / static_cast<float>(kReposeBlock);
      bare->x[at] = 0.01f * static_cast<float>(i);
      bare->y[at] = 0.003f * part;
      bare->z[at] = -0.006f * steepest * part * static_cast<float>(i);
      bare->area[at] = 1e-4f;
      bare->steep[at] = steepest * part;
      if (i + 1 < kReposeBlock) forward[static_cast<size_t>(i)] = 1;
    }
  }

  std::array<TilePlane, kForwardLinks> limits(const ReposeLimits& settings) const {
    std::array<TilePlane, kForwardLinks> all{};
    std::array<float*, kForwardLinks> rows;
    for (size_t k = 0; k < rows.size(); ++k) rows[k] = all[k].data();
    find_link_limits(*bare, 0, forward.data(), settings, rows.data());
    return all;
  }

  float expected(int32_t i, const ReposeLimits& settings) const {
    const size_t a = TileWindow::at(i, 0);
    const size_t b = a + 1;
    const float x = bare->x[b] - bare->x[a];
    const float y = bare->y[b] - bare->y[a];
    const float curvature = 0.5f * (bare->curvature[a] + bare->curvature[b]);
    return shared::link_limit(
        std::sqrt(x * x + y * y), shared::held_slope(settings.slope, settings.cohesion, curvature),
        bare->z[a] - bare->z[b], 0.5f * (bare->steep[a] + bare->steep[b]), shared::kLeadsDown);
  }
};

TEST(ReposeLinkLimits, AreTheSameWhereSomeOfTheSurfaceIsSteep) {
  for (const float steepest : {0.9f, 4.0f}) {
    for (const float cohesion : {0.0f, 0.01f}) {
      const SteepeningRow row(steepest);
      for (size_t i = 0; i < row.bare->curvature.size(); ++i) row.bare->curvature[i] = 40.0f;
      const ReposeLimits settings{.slope = kLimits.slope, .cohesion = cohesion};
      const auto limits = row.limits(settings);
      for (int32_t i = 0; i + 1 < kReposeBlock; ++i) {
        EXPECT_EQ(limits[0][static_cast<size_t>(i)], row.expected(i, settings)) << i;
      }
    }
  }
}

TEST(ReposeLinkLimits, AreInfiniteWithoutALinkOrATexelAndBesideAWall) {
  SteepeningRow row(0.9f);
  row.forward[3] = 0;
  row.bare->area[TileWindow::at(8, 0)] = 0.0f;
  row.bare->wall[TileWindow::at(20, 0)] = 1.0f;
  const auto limits = row.limits(kLimits);
  for (const size_t i : {size_t{3}, size_t{7}, size_t{8}, size_t{19}, size_t{20}, size_t{31}}) {
    EXPECT_EQ(limits[0][i], kNoLink) << i;
  }
  EXPECT_LT(limits[0][4], kNoLink);
  EXPECT_LT(limits[0][18], kNoLink);
  for (size_t k = 1; k < limits.size(); ++k) EXPECT_EQ(limits[k][5], kNoLink);
}

}  // namespace
}  // namespace snowbough::snow
