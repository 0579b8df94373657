#pragma once

// Small scenes on the GPU, for tests of single passes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "gpu/gpu_thread.h"
#include "snow/step/gl/occlusion.h"
#include "snow/step/gl/passes.h"
#include "snow/step/gl/scene_buffers.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// A square of `size` metres at height z whose UVs fill the map.
inline SceneObject square(const std::string& name, float size, float z, int32_t resolution = 64,
                          bool receive = true) {
  SceneObject object;
  object.description.name = name;
  object.description.receive = receive;
  MapTopology& topology = object.description.topology;
  topology.triangles = {0, 1, 2, 0, 2, 3};
  topology.corner_uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  topology.vertex_count = 4;
  topology.resolution = resolution;
  const float h = 0.5f * size;
  object.positions = {{-h, -h, z}, {h, -h, z}, {h, h, z}, {-h, h, z}};
  object.bounds.include(glm::dvec3(-h, -h, z));
  object.bounds.include(glm::dvec3(h, h, z));
  if (receive) {
    object.table = std::make_shared<const TexelTable>(build_texel_table(topology));
  }
  return object;
}

/// Compares an engine's stability with the closed form. stable_height(height, deposit, dt,
/// max_depth, is_ceiling) steps a texel with a half-life of 2 s.
template <typename StableHeight>
void expect_closed_form(const StableHeight& stable_height) {
  const double k = std::numbers::ln2 / 2.0;
  EXPECT_FLOAT_EQ(stable_height(0.1f, 0.2f, 1.0f, 0.5f, false), 0.3f);
  EXPECT_NEAR(stable_height(0.9f, 0.0f, 2.0f, 0.5f, false), 0.7f, 1e-6);
  EXPECT_NEAR(stable_height(0.5f, 0.3f, 1.0f, 0.5f, false), 0.5 + 0.3 * (1.0 - std::exp2(-0.5)) / k,
              1e-6);
  // Crosses at a third of the step.
  EXPECT_NEAR(stable_height(0.4f, 0.3f, 1.0f, 0.5f, false),
              0.5 + 0.2 * (1.0 - std::exp2(-1.0 / 3.0)) / (k * 2.0 / 3.0), 1e-6);
  EXPECT_NEAR(stable_height(0.1f, 0.0f, 20.0f, 0.0f, false), 0.1 * std::exp2(-10.0), 1e-7);
  // Past vertical, but no time to slide: a huge capacity rounds nothing away.
  EXPECT_FLOAT_EQ(stable_height(0.001f, 0.002f, 0.0f, 1e6f, true), 0.003f);
}

/// A scene on the GPU with everything a pass needs. Lives on the GPU thread.
struct Bench {
  explicit Bench(std::vector<SceneObject> given, FallSettings settings = {})
      : objects(std::move(given)) {
    std::vector<const SceneObject*> pointers;
    Bounds bounds;
    for (const SceneObject& object : objects) {
      pointers.push_back(&object);
      bounds.include(object.bounds);
    }
    scene = build_scene_buffers(pointers, info);
    for (size_t i = 0; i < objects.size(); ++i) {
      scene.positions.write(int64_t{12} * scene.layout.first_vertex[i],
                            static_cast<int64_t>(objects[i].positions.size()) * 12,
                            objects[i].positions.data());
    }
    frame = make_projection_frame(settings, bounds);
    projection = gpu::Buffer(sizeof frame, &frame);
    TriangleSetupPass().run(scene, projection);
    TexelSurfacePass().run(scene);
    std::vector<PixelRect> rects;
    for (const SceneObject& object : objects) {
      rects.push_back(pixels_of(object.bounds, frame));
    }
    tiles = make_tiles(rects, 2048);
    OcclusionPass().run(scene, projection, tiles.front(), {{0, scene.triangle_count}}, target);
  }

  /// Surfaces that the tile's own pixels show, row by row, and their depths in metres.
  std::vector<shared::SeenPixel> visible() const { return visible_in(tiles.front()); }

  /// The same of a tile that `target` shows.
  std::vector<shared::SeenPixel> visible_in(const Tile& tile) const {
    const auto all = target.visible.read_all<shared::SeenPixel>();
    const int32_t width = tile.with_margin().size().x;
    std::vector<shared::SeenPixel> own;
    for (int32_t y = 0; y < tile.pixels.size().y; ++y) {
      const auto row = all.begin() + (y + shared::kTileMargin) * width + shared::kTileMargin;
      own.insert(own.end(), row, row + tile.pixels.size().x);
    }
    return own;
  }

  gpu::GpuInfo info = gpu::GpuThread::shared()->info();
  std::vector<SceneObject> objects;
  SceneBuffers scene;
  shared::ProjectionFrame frame;
  gpu::Buffer projection;
  std::vector<Tile> tiles;
  OcclusionTarget target;
};

inline std::vector<SceneObject> objects_of(SceneObject a) {
  std::vector<SceneObject> objects;
  objects.push_back(std::move(a));
  return objects;
}

inline std::vector<SceneObject> objects_of(SceneObject a, SceneObject b) {
  std::vector<SceneObject> objects = objects_of(std::move(a));
  objects.push_back(std::move(b));
  return objects;
}

/// Two squares of their own charts, each on half of a 64 x 64 map, one up, one turned down.
inline SceneObject plate() {
  SceneObject object = square("plate", 1.0f, 0.0f);
  MapTopology& topology = object.description.topology;
  topology.triangles = {0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6};
  topology.corner_uv = {{0, 0},   {0.5, 0}, {0.5, 1}, {0, 0},   {0.5, 1}, {0, 1},
                        {0.5, 0}, {1, 1},   {1, 0},   {0.5, 0}, {0.5, 1}, {1, 1}};
  topology.vertex_count = 8;
  for (size_t i = 0; i < 4; ++i) {
    object.positions.push_back(object.positions[i] - glm::vec3(0.0f, 0.0f, 0.1f));
  }
  object.bounds.include(glm::dvec3(0.0, 0.0, -0.1));
  object.table = std::make_shared<const TexelTable>(build_texel_table(topology));
  return object;
}

inline FallSettings falling(glm::dvec3 direction, double pixel_size, double depth = 0.01) {
  FallSettings settings;
  settings.direction = glm::normalize(direction);
  settings.pixel_size = pixel_size;
  settings.depth = depth;
  return settings;
}

}  // namespace snowbough::snow
