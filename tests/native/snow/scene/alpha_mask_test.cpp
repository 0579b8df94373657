#include "snow/scene/alpha_mask.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>

namespace snowbough::snow {
namespace {

using ::testing::ElementsAre;

TEST(AlphaMask, KeepsWhatIsAtLeastHalfOpaque) {
  const AlphaMask mask = make_alpha_mask(5, 1, shared::kAlphaRepeat, {0, 127, 128, 255, 0});
  EXPECT_THAT(mask.bits, ElementsAre(0b01100u));
}

TEST(AlphaMask, HasABitATexelRowByRowLowestFirst) {
  std::vector<uint8_t> alpha(7 * 5, 0);
  alpha[4 * 7 + 6] = 255;
  const AlphaMask mask = make_alpha_mask(7, 5, shared::kAlphaClip, alpha);
  EXPECT_THAT(mask.bits, ElementsAre(0u, 1u << 2));
  EXPECT_EQ(mask.bytes(), 8);
  EXPECT_EQ(mask.extension, shared::kAlphaClip);
}

TEST(AlphaMask, OfTheWrongSizeIsRefused) {
  EXPECT_THROW(make_alpha_mask(0, 4, shared::kAlphaRepeat, {}), std::invalid_argument);
  EXPECT_THROW(make_alpha_mask(8193, 1, shared::kAlphaRepeat, std::vector<uint8_t>(8193)),
               std::invalid_argument);
  EXPECT_THROW(make_alpha_mask(2, 2, shared::kAlphaRepeat, {1, 2, 3}), std::invalid_argument);
}

TEST(AlphaExtension, IsKnownByFourNames) {
  EXPECT_EQ(alpha_extension("REPEAT"), shared::kAlphaRepeat);
  EXPECT_EQ(alpha_extension("MIRROR"), shared::kAlphaMirror);
  EXPECT_EQ(alpha_extension("EXTEND"), shared::kAlphaExtend);
  EXPECT_EQ(alpha_extension("CLIP"), shared::kAlphaClip);
  EXPECT_THROW(alpha_extension("repeat"), std::invalid_argument);
}

/// The alpha of one triangle with one image.
ObjectAlpha one_triangles() {
  return {{{0, 0}, {1, 0}, {0, 1}},
          {0},
          {std::make_shared<const AlphaMask>(make_alpha_mask(1, 1, shared::kAlphaRepeat, {255}))}};
}

TEST(ObjectAlpha, MustBelongToItsMesh) {
  EXPECT_NO_THROW(check_alpha(one_triangles(), 1));
  EXPECT_THROW(check_alpha(one_triangles(), 2), std::invalid_argument);
  ObjectAlpha alpha = one_triangles();
  alpha.mask = {1};
  EXPECT_THROW(check_alpha(alpha, 1), std::invalid_argument);
  alpha = one_triangles();
  alpha.mask = {-1};
  EXPECT_NO_THROW(check_alpha(alpha, 1));
  alpha.corner_uv[1].x = std::nanf("");
  EXPECT_THROW(check_alpha(alpha, 1), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::snow
