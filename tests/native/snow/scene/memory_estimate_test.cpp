#include "snow/scene/memory_estimate.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "native/snow/layouts.h"
#include "snow/seams/seam_leveller.h"
#include "snow/seams/seam_table.h"

namespace snowbough::snow {
namespace {

MapTopology plate_over_the_map(int32_t resolution) {
  MapTopology topology;
  topology.triangles = {0, 1, 2, 0, 2, 3};
  topology.corner_uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  topology.vertex_count = 4;
  topology.resolution = resolution;
  return topology;
}

TEST(MemoryEstimate, CountsAtLeastWhatLevellingKeeps) {
  SceneObject object;
  LaidOutMesh mesh = cylinder(24, 8, 0.5f, 2.0f, 256);
  for (const bool apart : {false, true}) {
    if (apart) lay_out_apart(mesh, 256);
    object.description.topology = mesh.topology;
    object.table = std::make_shared<const TexelTable>(build_texel_table(mesh.topology));
    const SeamTable seams = build_seam_table(mesh.topology, *object.table, mesh.positions);
    SeamLeveller leveller(seams.levelling);
    std::vector<float> map(256 * 256, 0.0f);
    for (size_t i = 0; i < map.size(); ++i) map[i] = 0.01f * static_cast<float>(i * 7 % 13);
    leveller.run(map);
    const int64_t kept =
        leveller.bytes() + 64 * static_cast<int64_t>(seams.levelling.points.size());
    const int64_t estimate = estimate_shared_memory({&object}).seams;
    EXPECT_GT(estimate, kept);
    EXPECT_LT(estimate, 5 * kept);
  }
}

TEST(MemoryEstimate, RefusesWhatDoesNotFitWithTheFigure) {
  SceneObject object;
  object.description.topology = plate_over_the_map(256);
  object.table = std::make_shared<const TexelTable>(build_texel_table(object.description.topology));
  const MemoryEstimate estimate = estimate_shared_memory({&object});
  EXPECT_EQ(estimate.maps, 256 * 256 * 4);
  EXPECT_NO_THROW(require_memory(estimate, int64_t{1} << 32));
  try {
    require_memory(estimate, 1 << 20);
    FAIL() << "must throw";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("1 MiB are free"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("resolution"), std::string::npos);
  }
}

}  // namespace
}  // namespace snowbough::snow
