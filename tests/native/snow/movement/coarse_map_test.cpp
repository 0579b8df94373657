#include "snow/movement/coarse_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "snow/movement/movement.h"

namespace snowbough::snow {
namespace {

constexpr float kPlate = 0.48f;
constexpr float kDepth = 0.048f;

/// A level plate; with a mask that takes all snow its own map is kept.
SceneObject plate(int32_t resolution, bool keeps_map = false) {
  SceneObject object;
  MapTopology& topology = object.description.topology;
  topology.resolution = resolution;
  topology.vertex_count = 4;
  topology.triangles = {0, 1, 2, 0, 2, 3};
  topology.corner_uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  object.description.name = "plate";
  object.description.sides = Sides::kPositive;
  object.positions = {{0, 0, 0}, {kPlate, 0, 0}, {kPlate, kPlate, 0}, {0, kPlate, 0}};
  object.description.rest = object.positions;
  for (const glm::vec3& corner : object.positions) object.bounds.include(glm::dvec3(corner));
  object.table = std::make_shared<const TexelTable>(build_texel_table(topology));
  if (keeps_map) {
    object.mask = std::make_shared<const std::vector<float>>(object.table->texel.size(), 1.0f);
  }
  return object;
}

/// A block of snow with upright sides, which do not lie between squares of texels.
std::vector<float> block(int32_t resolution) {
  const auto side = static_cast<size_t>(resolution);
  std::vector<float> height(side * side, 0.0f);
  for (size_t row = 0; row < side; ++row) {
    for (size_t column = 0; column < side; ++column) {
      const double x = (static_cast<double>(column) + 0.5) / static_cast<double>(side) - 0.5;
      const double y = (static_cast<double>(row) + 0.5) / static_cast<double>(side) - 0.5;
      if (std::abs(x) < 0.203 && std::abs(y) < 0.307) height[row * side + column] = kDepth;
    }
  }
  return height;
}

struct Rested {
  std::vector<float> height;
  MovingMap map;
  double rounds = 0.0;
};

Rested rest(const SceneObject& object) {
  Rested result;
  result.height = block(object.description.topology.resolution);
  Movement movement;
  movement.lay_out({&object});
  movement.forget_pose(0);
  std::vector<MovingMap> maps(1);
  maps[0].height = &result.height;
  MovementSettings settings;
  settings.repose.angle = 0.8;
  settings.landing.is_on = true;
  for (int step = 0; step < 4; ++step) {
    movement.after(settings, static_cast<uint32_t>(step), 0.25, maps);
    result.rounds += movement.rounds();
  }
  result.map = maps[0];
  return result;
}

double volume(const std::vector<float>& height) {
  double sum = 0.0;
  for (const float own : height) sum += static_cast<double>(own);
  return sum / static_cast<double>(height.size()) * static_cast<double>(kPlate) *
         static_cast<double>(kPlate);
}

TEST(CoarseMap, MakesReposeCostTheSameOnFinerTexels) {
  const double coarse = rest(plate(256)).rounds;
  EXPECT_GT(coarse, 0.0);
  EXPECT_LT(rest(plate(512)).rounds, 1.2 * coarse);
  // On texels of their own it takes many times as many.
  EXPECT_GT(rest(plate(512, true)).rounds, 6.0 * coarse);
}

TEST(CoarseMap, KeepsTheVolume) {
  const Rested after = rest(plate(512));
  EXPECT_TRUE(after.map.has_changed);
  EXPECT_NEAR(volume(after.height) + after.map.slid, volume(block(512)), 1e-7 * volume(block(512)));
}

TEST(CoarseMap, ShapesSnowAsTheReceiversOwnMapDoes) {
  const std::vector<float> fine = rest(plate(512, true)).height;
  const std::vector<float> coarse = rest(plate(512)).height;
  double most = 0.0;
  double mean = 0.0;
  for (size_t i = 0; i < fine.size(); ++i) {
    const double apart = std::abs(static_cast<double>(fine[i]) - static_cast<double>(coarse[i]));
    most = std::max(most, apart);
    mean += apart / static_cast<double>(fine.size());
  }
  RecordProperty("largest_difference_mm", std::to_string(1e3 * most));
  RecordProperty("mean_difference_mm", std::to_string(1e3 * mean));
  EXPECT_LT(most, 0.08 * static_cast<double>(kDepth));
  EXPECT_LT(mean, 0.01 * static_cast<double>(kDepth));
}

/// A plate that ends in a bevel of 60 degrees, two texels wide, and a wall below, all in one chart.
TEST(CoarseMap, SpreadsColumnsOverBevels) {
  constexpr int32_t kSide = 512;
  constexpr float kColumn = 0.1f;
  const float texel = kPlate / static_cast<float>(kSide);
  SceneObject object = plate(kSide);
  MapTopology& topology = object.description.topology;
  const std::vector<float> along = {0.0f, 482.0f, 484.0f, 512.0f};
  const std::vector<glm::vec2> profile = {
      {0.0f, 0.0f}, {482.0f, 0.0f}, {483.0f, -1.732f}, {483.0f, -29.732f}};
  object.positions.clear();
  topology.triangles.clear();
  topology.corner_uv.clear();
  for (const float y : {0.0f, kPlate}) {
    for (const glm::vec2& at : profile) object.positions.push_back({at.x * texel, y, at.y * texel});
  }
  for (int32_t i = 0; i < 3; ++i) {
    for (const int32_t corner : {i, i + 1, i + 5, i, i + 5, i + 4}) {
      topology.triangles.push_back(corner);
      topology.corner_uv.push_back(
          {along[static_cast<size_t>(corner % 4)] / 512.0f, corner < 4 ? 0.0f : 1.0f});
    }
  }
  topology.vertex_count = 8;
  object.description.rest = object.positions;
  object.table = std::make_shared<const TexelTable>(build_texel_table(topology));
  SceneRays rays;
  rays.lay_out({&object});
  ReposeLinkTables tables;
  const std::unique_ptr<CoarseMap> coarse = CoarseMap::make(object, 2, tables, rays);
  ASSERT_NE(coarse, nullptr);
  coarse->repose().ground();
  std::vector<float> height(size_t{kSide} * kSide, 0.0f);
  MovingMap map;
  map.height = &height;
  MovingMap moved = coarse->begin(map);
  for (size_t i = 0; i < moved.height->size(); ++i) {
    const size_t column = i % (kSide / 2);
    (*moved.height)[i] = column < 241 ? kColumn : column == 241 ? 0.5f * kColumn : 0.0f;
  }
  moved.has_changed = true;
  coarse->end(moved, map);
  const float* const row = &height[size_t{kSide} * (kSide / 2)];
  for (size_t column = 470; column < 482; ++column) EXPECT_NEAR(row[column], kColumn, 1e-4f);
  for (const size_t column : {482, 483}) EXPECT_NEAR(row[column], 0.5f * kColumn, 1e-4f);
}

TEST(CoarseMap, IsNoneWhereTexelsAreCoarse) {
  const SceneObject object = plate(64);
  std::vector<float> height = block(64);
  SceneRays rays;
  rays.lay_out({&object});
  CoarseMaps maps;
  maps.lay_out({&object}, rays);
  ReposeLinkTables tables;
  MovingMap map;
  map.height = &height;
  Repose own(object, tables);
  EXPECT_EQ(maps.choose(map, false, tables, own), nullptr);
}

}  // namespace
}  // namespace snowbough::snow
