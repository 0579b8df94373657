#include "snow/texels/texel_tables.h"

#include <gtest/gtest.h>

namespace snowbough::snow {
namespace {

MapTopology mapped_triangle() {
  MapTopology topology;
  topology.triangles = {0, 1, 2};
  topology.corner_uv = {{0.1f, 0.1f}, {0.9f, 0.1f}, {0.1f, 0.9f}};
  topology.vertex_count = 3;
  topology.resolution = 64;
  return topology;
}

TEST(TexelTables, EqualMeshesShareATable) {
  TexelTables tables;
  const auto first = tables.find_or_build(mapped_triangle());
  EXPECT_EQ(tables.find_or_build(mapped_triangle()), first);
  EXPECT_EQ(first->texel, build_texel_table(mapped_triangle()).texel);
}

TEST(TexelTables, MeshesThatDifferInAnythingDoNot) {
  TexelTables tables;
  const auto first = tables.find_or_build(mapped_triangle());
  MapTopology fine = mapped_triangle();
  fine.resolution = 128;
  MapTopology moved = mapped_triangle();
  moved.corner_uv[0].x = 0.2f;
  MapTopology rotated = mapped_triangle();
  rotated.triangles = {1, 2, 0};
  for (const MapTopology& other : {fine, moved, rotated}) {
    EXPECT_NE(tables.find_or_build(other), first);
    EXPECT_EQ(tables.find_or_build(other)->resolution, other.resolution);
  }
}

TEST(TexelTables, ATableThatNobodyUsesIsReleased) {
  TexelTables tables;
  const std::weak_ptr<const TexelTable> first = tables.find_or_build(mapped_triangle());
  EXPECT_TRUE(first.expired());
}

}  // namespace
}  // namespace snowbough::snow
