#pragma once

// Small scenes on the GPU, for tests of single passes.
#include <algorithm>
#include <glm/geometric.hpp>
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
