#include "snow/scene/fragment_opacity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

namespace snowbough::snow {
namespace {

using ::testing::Each;
using ::testing::IsEmpty;

/// A square over a whole map of 64 texels, and its image over the whole square.
struct ImageOnASquare {
  MapTopology topology;
  TexelTable table;
  ObjectAlpha alpha;

  explicit ImageOnASquare(AlphaMask mask) {
    topology.triangles = {0, 1, 2, 0, 2, 3};
    topology.corner_uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    topology.vertex_count = 4;
    topology.resolution = 64;
    table = build_texel_table(topology);
    alpha.corner_uv = topology.corner_uv;
    alpha.mask = {0, 0};
    alpha.masks = {std::make_shared<const AlphaMask>(std::move(mask))};
  }

  std::vector<float> opacity() const { return fragment_opacity(table, topology, alpha); }
};

TEST(FragmentOpacity, IsNotStoredWithoutAnImage) {
  ImageOnASquare scene(make_alpha_mask(1, 1, shared::kAlphaRepeat, {0}));
  scene.alpha = {};
  EXPECT_THAT(scene.opacity(), IsEmpty());
}

TEST(FragmentOpacity, IsOneWithoutAnImageAndZeroInHoles) {
  ImageOnASquare scene(make_alpha_mask(1, 1, shared::kAlphaRepeat, {0}));
  EXPECT_THAT(scene.opacity(), Each(0.0f));
  scene.alpha.mask = {-1, -1};
  EXPECT_THAT(scene.opacity(), Each(1.0f));
}

TEST(FragmentOpacity, FollowsTheImageFromTexelToTexel) {
  // The left half is there.
  const ImageOnASquare scene(make_alpha_mask(2, 1, shared::kAlphaRepeat, {255, 0}));
  const std::vector<float> opacity = scene.opacity();
  const TexelTable& table = scene.table;
  for (size_t i = 0; i < table.texel.size(); ++i) {
    for (int32_t f = table.fragment_begin[i]; f < table.fragment_begin[i + 1]; ++f) {
      ASSERT_EQ(opacity[f], table.texel[i] % 64 < 32 ? 1.0f : 0.0f) << "texel " << i;
    }
  }
}

TEST(FragmentOpacity, OfALargeTexelIsTheMeanOfItsImage) {
  // A chequered image of 128 x 128 on 64 texels: 2 x 2 each, of which two are there.
  std::vector<uint8_t> chequered(128 * 128);
  for (size_t i = 0; i < chequered.size(); ++i) {
    chequered[i] = (i % 128 + i / 128) % 2 == 0 ? 255 : 0;
  }
  const ImageOnASquare scene(make_alpha_mask(128, 128, shared::kAlphaRepeat, chequered));
  const std::vector<float> opacity = scene.opacity();
  const TexelTable& table = scene.table;
  for (size_t i = 0; i < table.texel.size(); ++i) {
    if (table.texel[i] % 64 == table.texel[i] / 64) continue;  // the diagonal cuts these in two
    ASSERT_EQ(opacity[table.fragment_begin[i]], 0.5f) << "texel " << i;
  }
}

}  // namespace
}  // namespace snowbough::snow
