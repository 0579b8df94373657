#include "snow/texels/sheets.h"

#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

TEST(Sheets, AreWhatSharesVertices) {
  // Two triangles on an edge, one at one of their corners, one separate.
  const Sheets sheets = find_sheets({0, 1, 2, 2, 1, 3, 3, 4, 5, 6, 7, 8}, 9);
  EXPECT_EQ(sheets.sheet, (std::vector<int32_t>{0, 0, 0, 1}));
  EXPECT_EQ(sheets.count, 2);
}

TEST(Sheets, AreNumberedByTheirFirstTriangles) {
  const Sheets sheets = find_sheets({6, 7, 8, 0, 1, 2, 8, 7, 9}, 10);
  EXPECT_EQ(sheets.sheet, (std::vector<int32_t>{0, 1, 0}));
}

TEST(Sheets, OfNothingAreNone) {
  EXPECT_EQ(find_sheets({}, 0).count, 0);
}

}  // namespace
}  // namespace snowbough::snow
