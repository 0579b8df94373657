#include "render/draw/draw_kind.h"

#include <gtest/gtest.h>

namespace snowbough::render {
namespace {

using Defines = std::vector<std::string>;

TEST(DrawKind, aPictureNeedsNoDefine) {
  EXPECT_EQ(defines_of(DrawKind::kShaded), Defines{});
}

TEST(DrawKind, eachOtherKindHasItsOwn) {
  EXPECT_EQ(defines_of(DrawKind::kWire), Defines{"WIRE"});
  EXPECT_EQ(defines_of(DrawKind::kDepth), Defines{"SHADOW"});
  EXPECT_EQ(defines_of(DrawKind::kCapture), Defines{"CAPTURE"});
}

}  // namespace
}  // namespace snowbough::render
