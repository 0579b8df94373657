#include "render/tree/drop_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "shaders/lib/thin_limbs.h"

namespace snowbough::render {
namespace {

/// True if shaders/tree_classify.comp.glsl drops a patch at a scale.
bool is_dropped(const DropSize& of, float snow, float scale) {
  const float width = shared::drawn_share(shared::kDrawnWidth * (of.reach + snow) * scale, 1.0f);
  if (width >= 1.0f) return false;
  if (of.number >= 1.0f) return true;
  const float length = shared::drawn_share(of.length * scale, shared::kMinLength);
  return shared::area_factor(width * length, of.number) <= 0.0f;
}

std::vector<DropSize> sizes_in_order() {
  std::vector<DropSize> sizes;
  for (int i = 0; i < 500; ++i) {
    const float reach = 0.001f * static_cast<float>(1 + i % 7 * i % 5);
    sizes.push_back({reach, 0.05f * static_cast<float>(1 + i % 11),
                     i % 50 == 0 ? 1.0f : shared::patch_number(i)});
  }
  std::stable_sort(sizes.begin(), sizes.end(), [](const DropSize& a, const DropSize& b) {
    return drop_point(a, 0.0f) < drop_point(b, 0.0f);
  });
  return sizes;
}

TEST(DropOrder, everyDrawnItemIsKeptAndFewOthers) {
  const std::vector<DropSize> sizes = sizes_in_order();
  DropOrder order(sizes);
  const float never = std::numeric_limits<float>::max();
  for (const float snow : {0.0f, 0.0007f, 0.05f}) {
    for (float scale = 1.0f; scale < 3000.0f; scale *= 1.3f) {
      const int32_t needed = order.needed(scale, snow, never);
      int32_t drawn = 0;
      for (size_t i = 0; i < sizes.size(); ++i) {
        if (is_dropped(sizes[i], snow, scale)) continue;
        ++drawn;
        EXPECT_LT(static_cast<int32_t>(i), needed) << snow << " " << scale;
      }
      if (snow == 0.0f) {
        EXPECT_LE(needed, drawn + 2) << scale;
      }
    }
  }
}

TEST(DropOrder, theTessellatedStay) {
  DropOrder order(sizes_in_order());
  const float never = std::numeric_limits<float>::max();
  EXPECT_LT(order.needed(2.0f, 0.0f, never), order.count() / 4);
  EXPECT_EQ(order.needed(2.0f, 0.0f, 0.001f), order.count());
  EXPECT_EQ(order.needed(2.0f, std::numeric_limits<float>::infinity(), never), order.count());
}

TEST(DropOrder, aLeafIsDroppedAtItsPoint) {
  const float point = leaf_drop_point(0.04f, 0.6f);
  const auto factor = [](float scale) {
    const float share = shared::drawn_share(2.0f * 0.04f * scale, shared::kMinLeaf);
    return shared::area_factor(share * share, 0.6f);
  };
  EXPECT_EQ(factor(0.999f * point), 0.0f);
  EXPECT_GT(factor(1.001f * point), 0.0f);
}

}  // namespace
}  // namespace snowbough::render
