#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tree/chart_shape.h"
#include "tree/surface_bark_uvs.h"
#include "tree/surface_path.h"
#include "tree/width.h"
#include "tree_surface_skeletons.h"

namespace snowbough::tree {
namespace {

using testing::Each;
using testing::ElementsAre;

/// A strip of rows 2 m long around a limb of 1 m perimeter.
Strip even_strip(int rows, double perimeter = 1.0) {
  Strip strip;
  strip.rings.resize(rows + 1);
  for (StripRing& ring : strip.rings) {
    ring.sides.fill(0.25 * perimeter);
  }
  strip.rows.resize(rows);
  for (StripRow& row : strip.rows) {
    row.area = 2.0 * perimeter;
  }
  return strip;
}

TEST(Charts, ARowIsAsLongAsItsAreaOverItsWidth) {
  EXPECT_THAT(row_lengths(even_strip(3), 10.0), Each(20.0));
}

TEST(Charts, ARowWidenedToTwoTexelsIsShortenedByHalfAtMost) {
  // Ten times too thin: its 20 texels become 10.
  EXPECT_THAT(row_lengths(even_strip(1, 0.02), 10.0), Each(testing::DoubleEq(10.0)));
}

TEST(Charts, AChartStandsOnItsRootCap) {
  Strip strip = even_strip(2);
  strip.root_cap = 7;
  const StripPiece piece{0, 0, 2, true, false};
  const ChartShape shape = shape_chart(strip, piece, row_lengths(strip, 10.0), 10.0, 1000.0);
  EXPECT_DOUBLE_EQ(shape.width, 10.0);
  EXPECT_THAT(shape.ring_y, ElementsAre(2.5, 22.5, 42.5));
  EXPECT_DOUBLE_EQ(shape.height, 42.5);
}

TEST(Charts, AFootprintCoversTheCellsThatTheChartTouches) {
  Strip strip = even_strip(2);
  strip.rings[2].sides.fill(0.1);
  const StripPiece piece{0, 0, 2, false, false};
  ChartShape shape;
  shape.piece = piece;
  shape.ring_y = {0.0, 20.0, 26.0};
  shape.ring_width = {10.0, 10.0, 4.0};
  shape.width = 10.0;
  shape.height = 26.0;
  const PackShape outline = footprint(shape, strip, 1);
  EXPECT_EQ(outline.width, 10);
  EXPECT_EQ(outline.height, 26);
  EXPECT_EQ(outline.gutter, 2);
  EXPECT_THAT(outline.begin, Each(0));
  // The upper row loses a column's width in every texel.
  EXPECT_THAT(outline.end, ElementsAre(26, 26, 26, 26, 26, 25, 24, 23, 22, 21));
}

TEST(BarkUvs, GoOnceRoundAndGrowByLengthOverCircumference) {
  const Skeleton skeleton = make_skeleton({trunk()});
  const SurfaceScale scale = surface_scale(skeleton);
  const std::vector<LimbPath> paths = limb_paths(skeleton, limb_widths(skeleton, {}), scale);
  const Surface surface = build_surface(skeleton, paths, scale, {}, {0});
  const std::vector<QuadUv> uvs = layout_bark_uvs(surface);
  ASSERT_EQ(uvs.size(), surface.quads.size());
  const LimbSurface& limb = surface.limbs[0];
  float across = 0.0f, highest = 0.0f;
  for (size_t f = 0; f < uvs.size(); ++f) {
    if (surface.origins[f].part == FacePart::kWall) {
      highest = std::max({highest, uvs[f][2].y, uvs[f][3].y});
      across += surface.origins[f].row == 0 ? uvs[f][1].x - uvs[f][0].x : 0.0f;
    }
  }
  const double side = glm::distance(surface.vertices[limb.rings[0].vertices[0]],
                                    surface.vertices[limb.rings[0].vertices[1]]);
  EXPECT_NEAR(across, 1.0f, 1e-5f);
  EXPECT_NEAR(highest, 10.0 / (4.0 * side), 0.01 * highest);
}

}  // namespace
}  // namespace snowbough::tree
