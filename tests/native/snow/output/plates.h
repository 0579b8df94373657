#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <random>
#include <utility>
#include <vector>

#include "native/snow/layouts.h"
#include "snow/output/smoothing.h"
#include "snow/seams/seam_table.h"
#include "snow/texels/texel_table.h"

// Maps with heights, for the tests of output.
namespace snowbough::snow {

struct Map {
  LaidOutMesh mesh;
  TexelTable table;
  SeamTable seams;
};

inline Map make_map(LaidOutMesh mesh) {
  Map map{std::move(mesh), {}, {}};
  map.table = build_texel_table(map.mesh.topology);
  map.seams = build_seam_table(map.mesh.topology, map.table, map.mesh.positions);
  return map;
}

/// Adds a rectangle in the plane z = 0 with vertices of its own: `low` to `high` on the map,
/// `size_x` by `size_y` metres in space at x = `left`.
inline void add_plate(LaidOutMesh& mesh, glm::vec2 low, glm::vec2 high, float left, float size_x,
                      float size_y) {
  const int32_t v = mesh.topology.vertex_count;
  mesh.topology.vertex_count += 4;
  for (const glm::vec2 c : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
    mesh.positions.emplace_back(left + c.x * size_x, c.y * size_y, 0.0f);
  }
  for (const int k : {0, 1, 2, 0, 2, 3}) mesh.topology.triangles.push_back(v + k);
  for (const glm::vec2 c : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 0),
                            glm::vec2(1, 1), glm::vec2(0, 1)}) {
    mesh.topology.corner_uv.push_back(low + c * (high - low));
  }
}

/// One plate over the whole map, `size_x` by `size_y` metres.
inline Map plate(int32_t resolution, float size_x, float size_y) {
  LaidOutMesh mesh;
  mesh.topology.resolution = resolution;
  add_plate(mesh, glm::vec2(0), glm::vec2(1), 0, size_x, size_y);
  return make_map(std::move(mesh));
}

/// A strip of 2 x 1 metres, bent nowhere, cut in the middle: 16 x 16 texels each, columns 8 to 23
/// and 40 to 55 of a map of 64, rows 8 to 23.
inline Map cut_strip() {
  LaidOutMesh mesh;
  mesh.topology.resolution = 64;
  mesh.topology.vertex_count = 6;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}};
  mesh.topology.triangles = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
  const auto uv = [](float x, float y) { return glm::vec2(x, y) / 64.0f; };
  mesh.topology.corner_uv = {uv(8, 8),  uv(24, 8), uv(24, 24), uv(8, 8),  uv(24, 24), uv(8, 24),
                             uv(40, 8), uv(56, 8), uv(56, 24), uv(40, 8), uv(56, 24), uv(40, 24)};
  return make_map(std::move(mesh));
}

inline std::vector<float> blanket(const Map& map, float height) {
  std::vector<float> values(static_cast<size_t>(map.table.resolution) * map.table.resolution, 0.0f);
  for (const int32_t texel : map.table.texel) values[texel] = height;
  return values;
}

inline std::vector<float> smooth(const Map& map, float radius, std::vector<float> heights,
                                 int32_t threads = 2) {
  const SmoothingGrid grid = build_smoothing_grid(map.table, map.seams);
  Smoother(grid, {radius}, threads).run(heights);
  return heights;
}

inline double volume(const Map& map, const std::vector<float>& heights) {
  double sum = 0.0;
  for (size_t i = 0; i < map.table.texel.size(); ++i) {
    sum += double{map.seams.texel_area[i]} * heights[map.table.texel[i]];
  }
  return sum;
}

/// Deep snow with patches of bare ground, uneven throughout.
inline std::vector<float> patchy_snow(const Map& map, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> heights = blanket(map, 0.0f);
  const int32_t size = map.table.resolution;
  for (const int32_t texel : map.table.texel) {
    const bool bare = (texel % size / 16 + texel / size / 16) % 3 == 0;
    if (!bare) heights[texel] = 0.05f + 1e-4f * static_cast<float>(random() % 2000);
  }
  return heights;
}

inline std::vector<float> random_map(const Map& map, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> stored(static_cast<size_t>(map.table.resolution) * map.table.resolution, 0.0f);
  for (const int32_t texel : map.table.texel)
    stored[texel] = 0.03f + static_cast<float>(random() % 1000) * 1e-4f;
  return stored;
}

}  // namespace snowbough::snow
