#include "snow/step/cpu/fragment_runs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

#include "shaders/lib/snow_shared.h"
#include "snow/texels/texel_order.h"

namespace snowbough::snow::cpu {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A square over the whole map, `cells` x `cells` quads of two triangles.
SceneObject quads(int32_t cells, int32_t resolution) {
  SceneObject object;
  MapTopology& topology = object.description.topology;
  topology.resolution = resolution;
  topology.vertex_count = (cells + 1) * (cells + 1);
  for (int32_t y = 0; y < cells; ++y) {
    for (int32_t x = 0; x < cells; ++x) {
      for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) {
        topology.triangles.push_back((y + dy) * (cells + 1) + x + dx);
        topology.corner_uv.emplace_back(glm::vec2(x + dx, y + dy) / static_cast<float>(cells));
      }
    }
  }
  object.table = std::make_shared<const TexelTable>(build_texel_table(topology));
  return object;
}

/// The texel of the map to which a fragment of a group belongs.
int32_t texel_of(const SceneObject& object, const std::vector<int32_t>& order,
                 const FragmentRuns& all, size_t group, uint32_t fragment) {
  return object.table->texel[order[group * shared::kTexelGroup + all.texel[fragment]]];
}

TEST(FragmentRuns, HoldOneTrianglesFragmentsInASquareOfSixteenTexels) {
  static_assert(shared::kTexelGroup == 1024 && kRunSquare == 16);
  const SceneObject object = quads(1, 64);
  const FragmentRuns all = make_fragment_runs(object, texel_order(*object.table), 0);
  // The diagonal goes through two squares of the first group and two of the last.
  EXPECT_THAT(all.group_begin, ElementsAre(0, 6, 10, 14, 20));
  std::vector<uint32_t> triangles;
  for (const FragmentRuns::Run& run : all.runs) triangles.push_back(run.triangle);
  triangles.pop_back();  // the end marker's
  EXPECT_THAT(triangles, ElementsAre(0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 1, 1, 1));
  EXPECT_EQ(all.runs.back().begin, all.texel.size());
}

TEST(FragmentRuns, StayWithinOneSquareOfTexels) {
  const SceneObject object = quads(3, 100);
  const std::vector<int32_t> order = texel_order(*object.table);
  const FragmentRuns all = make_fragment_runs(object, order, 0);
  for (size_t group = 0; group + 1 < all.group_begin.size(); ++group) {
    for (uint32_t r = all.group_begin[group]; r < all.group_begin[group + 1]; ++r) {
      const uint32_t begin = all.runs[r].begin;
      const uint32_t end = all.runs[r + 1].begin;
      ASSERT_LT(begin, end);
      ASSERT_LE(end - begin, kMaxInRun);
      const int32_t first = texel_of(object, order, all, group, begin);
      for (uint32_t f = begin + 1; f < end; ++f) {
        const int32_t texel = texel_of(object, order, all, group, f);
        ASSERT_EQ(texel / 100 / kRunSquare, first / 100 / kRunSquare);
        ASSERT_EQ(texel % 100 / kRunSquare, first % 100 / kRunSquare);
      }
    }
  }
}

TEST(FragmentRuns, HoldEveryFragmentOfTheTableOnce) {
  const SceneObject object = quads(3, 100);
  const TexelTable& table = *object.table;
  const std::vector<int32_t> order = texel_order(table);
  const FragmentRuns all = make_fragment_runs(object, order, 7);
  struct Values {
    float share, b, c;
    bool operator==(const Values&) const = default;
  };
  std::map<std::pair<int32_t, uint32_t>, Values> expected, made;
  for (size_t i = 0; i < table.texel.size(); ++i) {
    for (int32_t f = table.fragment_begin[i]; f < table.fragment_begin[i + 1]; ++f) {
      const auto triangle = static_cast<uint32_t>(table.fragment_triangle[f]) + 7;
      expected[{table.texel[i], triangle}] = {table.fragment_share[f],
                                              table.fragment_barycentric[f].x,
                                              table.fragment_barycentric[f].y};
    }
  }
  for (size_t group = 0; group + 1 < all.group_begin.size(); ++group) {
    for (uint32_t r = all.group_begin[group]; r < all.group_begin[group + 1]; ++r) {
      for (uint32_t f = all.runs[r].begin; f < all.runs[r + 1].begin; ++f) {
        made[{texel_of(object, order, all, group, f), all.runs[r].triangle}] = {
            all.share[f], all.weight_b[f], all.weight_c[f]};
      }
    }
  }
  EXPECT_EQ(all.texel.size(), table.fragment_share.size());
  EXPECT_TRUE(made == expected);
}

TEST(FragmentRuns, BoundTheWeightsOfTheirCentroids) {
  const SceneObject object = quads(3, 100);
  const FragmentRuns all = make_fragment_runs(object, texel_order(*object.table), 0);
  for (size_t r = 0; r + 1 < all.runs.size(); ++r) {
    const FragmentRuns::Run& run = all.runs[r];
    const auto begin = static_cast<std::ptrdiff_t>(run.begin);
    const auto end = static_cast<std::ptrdiff_t>(all.runs[r + 1].begin);
    const auto [least_b, most_b] =
        std::minmax_element(all.weight_b.begin() + begin, all.weight_b.begin() + end);
    const auto [least_c, most_c] =
        std::minmax_element(all.weight_c.begin() + begin, all.weight_c.begin() + end);
    ASSERT_EQ(run.least_b, *least_b);
    ASSERT_EQ(run.most_b, *most_b);
    ASSERT_EQ(run.least_c, *least_c);
    ASSERT_EQ(run.most_c, *most_c);
    float least_sum = 3.0f;
    float most_sum = -1.0f;
    for (auto f = static_cast<size_t>(begin); f < static_cast<size_t>(end); ++f) {
      least_sum = std::min(least_sum, all.weight_b[f] + all.weight_c[f]);
      most_sum = std::max(most_sum, all.weight_b[f] + all.weight_c[f]);
    }
    ASSERT_EQ(run.least_sum, least_sum);
    ASSERT_EQ(run.most_sum, most_sum);
  }
}

TEST(FragmentRuns, HoldTheOpacityOfFragmentsWithAnImage) {
  SceneObject object = quads(2, 64);
  const std::vector<int32_t> order = texel_order(*object.table);
  EXPECT_THAT(make_fragment_runs(object, order, 0).opacity, IsEmpty());
  // Half of the second triangle is opaque.
  for (const int32_t triangle : object.table->fragment_triangle) {
    object.fragment_opacity.push_back(triangle == 1 ? 0.5f : 1.0f);
  }
  const FragmentRuns all = make_fragment_runs(object, order, 0);
  for (size_t r = 0; r + 1 < all.runs.size(); ++r) {
    for (uint32_t f = all.runs[r].begin; f < all.runs[r + 1].begin; ++f) {
      ASSERT_EQ(all.opacity[f], all.runs[r].triangle == 1 ? 0.5f : 1.0f);
    }
  }
}

}  // namespace
}  // namespace snowbough::snow::cpu
