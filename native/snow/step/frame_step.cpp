#include "snow/step/frame_step.h"

#include <algorithm>
#include <cmath>

namespace snowbough::snow {
namespace {

bool overlap(const PixelRect& a, const PixelRect& b) {
  return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
}

void update_moved(Engine& engine, Movement& movement, const std::vector<SceneObject*>& objects) {
  for (size_t i = 0; i < objects.size(); ++i) {
    if (objects[i]->moved) {
      const std::vector<glm::vec3>& points = objects[i]->positions;
      // A surface without extent gains and blocks nothing.
      const bool collapses = objects[i]->hidden && !points.empty();
      engine.set_positions(
          i, collapses ? std::vector<glm::vec3>(points.size(), points.front()) : points);
      movement.forget_pose(i);
      objects[i]->moved = false;
    }
  }
}

/// The snow of a hidden receiver.
struct HiddenSnow {
  size_t object = 0;
  std::vector<float> height;
  shared::ObjectSums sums;
};

/// Reads the snow of hidden receivers: the passes would move it, since it has no slope.
std::vector<HiddenSnow> read_hidden(Engine& engine, const std::vector<SceneObject*>& objects) {
  std::vector<HiddenSnow> hidden;
  for (size_t i = 0; i < objects.size(); ++i) {
    if (!objects[i]->hidden || !objects[i]->description.receive) continue;
    HiddenSnow& one = hidden.emplace_back(HiddenSnow{i, {}, engine.read_sums(i)});
    engine.read_height(i, one.height);
    one.sums.deposited = one.sums.slid = one.sums.visible_area = one.sums.back_face_area = 0.0;
    one.sums.held_before = one.sums.held;
  }
  return hidden;
}

/// Triangles of the objects that may show in `shown`; adjacent ranges are merged.
std::vector<TriangleRange> ranges_in(const std::vector<SceneObject*>& objects,
                                     const SceneLayout& layout, const std::vector<PixelRect>& rects,
                                     const PixelRect& shown) {
  std::vector<TriangleRange> ranges;
  for (size_t i = 0; i < objects.size(); ++i) {
    const ObjectDescription& object = objects[i]->description;
    if (!(object.receive || object.occlude) || !overlap(rects[i], shown)) {
      continue;
    }
    const int32_t first = layout.first_triangle[i];
    const int32_t count = objects[i]->triangle_count();
    TriangleRange range{first, count};
    if (layout.first_alpha[i] >= 0) {
      range.has_alpha = true;
      range.alpha_offset = layout.first_alpha[i] - first;
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

/// Tiles with the receivers that are shown, and where all objects lie on the grid.
struct Grid {
  std::vector<PixelRect> rects;
  std::vector<Tile> tiles;
};

Grid grid_of(const std::vector<SceneObject*>& objects, const shared::ProjectionFrame& frame,
             int32_t tile_size) {
  Grid grid;
  std::vector<PixelRect> receivers;
  for (const SceneObject* object : objects) {
    grid.rects.push_back(pixels_of(object->bounds, frame));
    if (object->description.receive && !object->hidden) receivers.push_back(grid.rects.back());
  }
  grid.tiles = make_tiles(receivers, tile_size);
  return grid;
}

/// Computes what light, or rain, along `direction` brings to the receivers, unless it is known: as
/// the deposit on maps of their own.
void find_light(Engine& engine, const std::vector<SceneObject*>& objects, const Bounds& bounds,
                const FrameStep& step, const glm::dvec3& direction, LightMap& map) {
  if (!(direction.z < 0.0)) {
    map = {};
    return;
  }
  if (map.direction == direction) return;
  map = {direction, std::vector<std::vector<float>>(objects.size())};
  // A metre on open, level ground.
  const shared::ProjectionFrame frame = make_projection_frame(
      {.direction = direction, .pixel_size = step.fall.pixel_size, .depth = 1.0}, bounds);
  const Grid grid = grid_of(objects, frame, step.tile_size);
  std::vector<std::vector<float>> heights(objects.size());
  std::vector<shared::ObjectSums> sums(objects.size());
  for (size_t i = 0; i < objects.size(); ++i) {
    if (!objects[i]->description.receive) continue;
    engine.read_height(i, heights[i]);
    sums[i] = engine.read_sums(i);
    engine.write_height(i, std::vector<float>(heights[i].size(), 0.0f));
  }
  engine.set_up_triangles(frame);
  engine.open_statistics();
  engine.choose_texels();
  for (const Tile& tile : grid.tiles) {
    engine.render_occlusion(tile,
                            ranges_in(objects, engine.layout(), grid.rects, tile.with_margin()));
    engine.gather_deposit(tile, &tile == &grid.tiles.front());
  }
  if (!grid.tiles.empty()) {
    engine.apply_stability({.max_depth = 1e6f, .half_life = 1e9f, .adhesion = 1.0f},
                           static_cast<float>(shared::snow_depth(frame)), 0.0f);
  }
  for (size_t i = 0; i < objects.size(); ++i) {
    if (!objects[i]->description.receive) continue;
    engine.read_height(i, map.light[i]);
    for (float& light : map.light[i]) light = std::abs(light);
    engine.write_height(i, heights[i]);
    engine.write_sums(i, sums[i]);
  }
}

}  // namespace

void run_step(Engine& engine, Movement& movement, const std::vector<SceneObject*>& objects,
              const FrameStep& step, std::vector<PassHash>* hashes) {
  update_moved(engine, movement, objects);
  // Extents and grid come from all objects, so that leaving out a receiver changes nothing.
  Bounds bounds;
  for (const SceneObject* object : objects) {
    bounds.include(object->bounds);
  }
  const std::vector<HiddenSnow> hidden = read_hidden(engine, objects);
  const shared::ProjectionFrame frame = make_projection_frame(step.fall, bounds);
  const MeltSettings& melt = step.movement.melt;
  const bool melts = melt.is_on() && step.dt > 0.0;
  if (melts) {
    find_light(engine, objects, bounds, step, step.sun, movement.sun);
    const glm::dvec3 rain = melt.is_wet && melt.rain > 0.0 ? step.fall.direction : glm::dvec3(0.0);
    find_light(engine, objects, bounds, step, rain, movement.rain);
  }
  const auto [rects, tiles] =
      step.fall.depth > 0.0 ? grid_of(objects, frame, step.tile_size) : Grid{};

  PassHasher hash(engine, objects, step.fall.step_number, hashes);
  hash.inputs(frame);
  engine.set_up_triangles(frame);
  hash.triangles();
  engine.open_statistics();
  // What lands in a step without movement would not be shaped.
  const bool lands = step.moves_snow() && step.dt > 0.0 && movement.has_arrivals(step.dt);
  const bool drifts = step.movement.drift.is_on();
  if (lands || melts || drifts || movement.acts_always()) {
    engine.move_snow(
        [&](std::vector<MovingMap>& maps) { movement.before(step.movement, step.dt, maps); });
  }
  engine.choose_texels();
  if (tiles.empty()) {
    engine.evaluate_texels();
  }
  for (const Tile& tile : tiles) {
    engine.render_occlusion(tile, ranges_in(objects, engine.layout(), rects, tile.with_margin()));
    hash.occlusion(tile);
    engine.count_back_faces(tile);
    engine.gather_deposit(tile, &tile == &tiles.front());
  }
  StabilitySettings stability = step.stability;
  stability.records_slid = step.moves_snow() && step.movement.landing.is_on;
  const double density = std::min(1.0, step.fall.noise_density);
  engine.apply_stability(stability, static_cast<float>(shared::snow_depth(frame) / density),
                         static_cast<float>(step.dt));
  hash.deposit();
  hash.heights("stability");
  if (step.moves_snow() || movement.acts_always()) {
    engine.move_snow([&](std::vector<MovingMap>& maps) {
      movement.after(step.movement, step.fall.step_number, step.dt, maps);
    });
  }
  hash.heights("repose");
  engine.close_statistics(static_cast<float>(step.fall.pixel_size * step.fall.pixel_size));
  for (const HiddenSnow& one : hidden) {
    engine.write_height(one.object, one.height);
    engine.write_sums(one.object, one.sums);
  }
  hash.statistics();
}

}  // namespace snowbough::snow
