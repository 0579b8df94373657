#include "snow/frame_step.h"

#include <algorithm>
#include <cmath>

namespace snowbough::snow {
namespace {

bool overlap(const PixelRect& a, const PixelRect& b) {
  return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
}

void upload_moved(const std::vector<SceneObject*>& objects, SceneBuffers& scene) {
  for (size_t i = 0; i < objects.size(); ++i) {
    if (objects[i]->moved) {
      scene.positions.write(int64_t{12} * scene.first_vertex[i],
                            static_cast<int64_t>(objects[i]->positions.size()) * 12,
                            objects[i]->positions.data());
      objects[i]->moved = false;
    }
  }
}

/// Triangles of the objects that may show in a tile; neighbours in one run.
std::vector<TriangleRange> ranges_in(const std::vector<SceneObject*>& objects,
                                     const SceneBuffers& scene, const std::vector<PixelRect>& rects,
                                     const PixelRect& tile) {
  std::vector<TriangleRange> ranges;
  for (size_t i = 0; i < objects.size(); ++i) {
    const ObjectDescription& object = objects[i]->description;
    if (!(object.receive || object.occlude) || !overlap(rects[i], tile)) {
      continue;
    }
    const int32_t first = scene.first_triangle[i];
    const int32_t count = objects[i]->triangle_count();
    TriangleRange range{first, count};
    if (scene.first_alpha[i] >= 0) {
      range.has_alpha = true;
      range.alpha_offset = scene.first_alpha[i] - first;
    }
    if (!ranges.empty() && ranges.back().first + ranges.back().count == first &&
        ranges.back().has_alpha == range.has_alpha &&
        ranges.back().alpha_offset == range.alpha_offset) {
      ranges.back().count += count;
    } else {
      ranges.push_back(range);
    }
  }
  return ranges;
}

}  // namespace

void FrameStep::run(const std::vector<SceneObject*>& objects, SceneBuffers& scene,
                    const Input& input) {
  upload_moved(objects, scene);
  // Extents and grid come from all objects, so that leaving out a receiver changes nothing.
  Bounds bounds;
  for (const SceneObject* object : objects) {
    bounds.include(object->bounds);
  }
  const shared::FallFrame frame = make_fall_frame(input.fall, bounds);
  fall_.write(0, sizeof frame, &frame);
  triangles_.run(scene, fall_);
  const bool by_geometry = input.mapping == DepositMapping::kGeometry;
  // GEOMETRY draws all texels.
  groups_.run(scene, by_geometry);

  std::vector<PixelRect> rects;
  std::vector<PixelRect> receivers;
  for (const SceneObject* object : objects) {
    rects.push_back(pixels_of(object->bounds, frame));
    if (object->description.receive) {
      receivers.push_back(rects.back());
    }
  }
  const std::vector<Tile> tiles =
      input.fall.depth > 0.0 ? make_tiles(receivers, input.tile_size) : std::vector<Tile>{};

  statistics_.open(scene);
  if (by_geometry || tiles.empty()) {
    surface_.run(scene);
  }
  if (by_geometry) {
    if (deposit_geometry_ == nullptr) {
      deposit_geometry_ = std::make_unique<DepositGeometryPass>();
    }
    deposit_geometry_->begin(scene);
  }
  const double density = std::min(1.0, input.fall.noise_density);
  for (const Tile& tile : tiles) {
    occlusion_.run(scene, fall_, tile, ranges_in(objects, scene, rects, tile.with_margin()),
                   target_);
    back_pixels_.run(scene, tile, target_);
    if (by_geometry) {
      deposit_geometry_->run(scene, fall_, tile, target_);
    } else {
      deposit_.run(scene, fall_, tile, target_, density < 1.0, &tile == &tiles.front());
    }
  }
  stability_.run(scene, input.stability, static_cast<float>(frame.range.z / density),
                 static_cast<float>(input.dt), by_geometry);
  const double pixel_area = input.fall.pixel_size * input.fall.pixel_size;
  statistics_.close(scene, static_cast<float>(pixel_area));
}

}  // namespace snowbough::snow
