#include "snow/step/gl/engine.h"

#include <algorithm>
#include <utility>

#include "snow/step/gl/memory.h"
#include "snow/step/gl/passes.h"

namespace snowbough::snow::gl {

GlEngine::~GlEngine() {
  if (passes_ == nullptr) return;
  if (thread_->is_in_this_process()) {
    thread_->run([this] { passes_.reset(); });
  } else {
    static_cast<void>(passes_.release());
  }
}

MemoryEstimate GlEngine::memory(const std::vector<const SceneObject*>& objects,
                                int32_t tile_size) const {
  MemoryEstimate estimate = gl::estimate_memory(objects, tile_size);
  if (by_geometry_) estimate.maps += GeometryDeposit::memory(objects);
  return estimate;
}

void GlEngine::build_scene(const std::vector<const SceneObject*>& objects) {
  if (passes_ == nullptr) {
    passes_ = std::make_unique<Passes>();
    passes_->timer.set_enabled(measures_);
  }
  passes_->scene = SceneBuffers{};
  passes_->geometry.reset();
  passes_->live_filters.clear();
  passes_->scene = build_scene_buffers(objects, thread_->info());
  if (by_geometry_) passes_->geometry = std::make_unique<GeometryDeposit>(objects, passes_->scene);
  passes_->objects = objects;
}

void GlEngine::set_positions(size_t object, const std::vector<glm::vec3>& positions) {
  passes_->scene.positions.write(int64_t{12} * layout().first_vertex[object],
                                 static_cast<int64_t>(positions.size()) * 12, positions.data());
  passes_->scene.normals_are_current = false;
}

void GlEngine::move_snow(const std::function<void(std::vector<MovingMap>&)>& move) {
  const auto measured = passes_->timer.measure("movement");
  const std::vector<int32_t>& groups = layout().plan.group;
  std::vector<std::vector<float>> heights(groups.size());
  std::vector<MovingMap> maps;
  for (size_t object = 0; object < groups.size(); ++object) {
    if (groups[object] < 0) continue;
    read_height(object, heights[object]);
    maps.emplace_back(object, &heights[object]);
  }
  if (std::exchange(records_slid_, false)) collect_slid(maps);
  move(maps);
  bool has_changed = false;
  for (const MovingMap& map : maps) {
    if (map.has_changed) group_of(map.object).write_height(layer_of(map.object), *map.height);
    has_changed = has_changed || map.has_changed;
    if (map.slid == 0.0 && map.landed == 0.0 && map.removed() == 0.0) continue;
    shared::ObjectSums sums = read_sums(map.object);
    sums.slid += map.slid;
    sums.held -= map.slid;
    sums.landed += map.landed;
    count_removed(map, sums);
    write_sums(map.object, sums);
  }
  if (has_changed) passes_->groups.find_snow(passes_->scene);
}

void GlEngine::collect_slid(std::vector<MovingMap>& maps) {
  std::vector<MovingMap*> by_slot(layout().plan.slot.size(), nullptr);
  for (MovingMap& map : maps) {
    by_slot[static_cast<size_t>(layout().plan.slot[map.object])] = &map;
  }
  std::vector<float> slid;
  std::vector<uint32_t> places;
  for (const TexelBatch& batch : passes_->scene.batches) {
    const MapGroup& group = passes_->scene.groups[static_cast<size_t>(batch.group)];
    const auto texels = static_cast<uint32_t>(group.resolution * group.resolution);
    slid.resize(static_cast<size_t>(batch.count));
    places.resize(slid.size());
    batch.slid.read(0, int64_t{4} * batch.count, slid.data());
    batch.places.read(0, int64_t{4} * batch.count, places.data());
    for (size_t i = 0; i < slid.size(); ++i) {
      if (slid[i] <= 0.0f) continue;
      const auto slot = static_cast<uint32_t>(group.first_slot) + places[i] / texels;
      by_slot[slot]->slid_from.emplace_back(static_cast<int32_t>(places[i] % texels), slid[i]);
    }
  }
}

void GlEngine::read_height(size_t object, std::vector<float>& height) {
  group_of(object).read_height(layer_of(object), height);
}

void GlEngine::write_height(size_t object, const std::vector<float>& height) {
  group_of(object).write_height(layer_of(object), height);
  TexelGroupsPass::forget(passes_->scene);
}

std::shared_ptr<const gpu::ThreadTexture> GlEngine::live_output(size_t object,
                                                                const SceneObject& receiver,
                                                                const SeamTable& seams,
                                                                double blur_radius) {
  std::unique_ptr<LiveFilter>& filter = passes_->live_filters[object];
  if (filter == nullptr) {
    filter = std::make_unique<LiveFilter>(thread_, *receiver.table, seams, blur_radius);
  }
  const auto measured = passes_->timer.measure("output");
  group_of(object).height.copy_to(layer_of(object), GL_RED, GL_FLOAT, filter->map());
  return std::make_shared<const gpu::ThreadTexture>(filter->run());
}

void GlEngine::measure_passes(bool on) {
  measures_ = on;
  if (passes_ != nullptr) passes_->timer.set_enabled(on);
}

std::vector<PassCost> GlEngine::take_costs() {
  std::vector<PassCost> costs;
  if (passes_ == nullptr) return costs;
  for (const gpu::PassTime& pass : passes_->timer.take()) {
    auto cost = std::find_if(costs.begin(), costs.end(),
                             [&](const PassCost& known) { return known.name == pass.name; });
    if (cost == costs.end()) cost = costs.insert(cost, PassCost{pass.name});
    ++cost->calls;
    cost->gpu_seconds += pass.gpu_seconds;
    cost->wall_seconds += pass.wall_seconds;
  }
  return costs;
}

std::vector<glm::vec4> GlEngine::read_triangles(const TriangleRange& range) {
  const int64_t first = range.first, count = range.count;
  std::vector<glm::vec4> data(4 * static_cast<size_t>(count));
  passes_->scene.triangle_corners.read(48 * first, 48 * count, data.data());
  passes_->scene.triangle_surface.read(16 * first, 16 * count, data.data() + 3 * count);
  return data;
}

std::vector<shared::SeenPixel> GlEngine::read_occlusion(const Tile& tile) {
  const glm::ivec2 size = tile.with_margin().size();
  std::vector<shared::SeenPixel> pixels(static_cast<size_t>(size.x) * static_cast<size_t>(size.y));
  passes_->target.visible.read(0, static_cast<int64_t>(pixels.size() * sizeof(shared::SeenPixel)),
                               pixels.data());
  return pixels;
}

shared::ObjectSums GlEngine::read_sums(size_t object) {
  shared::ObjectSums sums;
  passes_->scene.sums.read(sums_offset(object), sizeof sums, &sums);
  return sums;
}

void GlEngine::write_sums(size_t object, const shared::ObjectSums& sums) {
  passes_->scene.sums.write(sums_offset(object), sizeof sums, &sums);
}

MapGroup& GlEngine::group_of(size_t object) {
  return passes_->scene.groups[static_cast<size_t>(layout().plan.group[object])];
}

int32_t GlEngine::layer_of(size_t object) {
  return layout().plan.slot[object] - group_of(object).first_slot;
}

int64_t GlEngine::sums_offset(size_t object) const {
  return int64_t{layout().plan.slot[object]} * static_cast<int64_t>(sizeof(shared::ObjectSums));
}

std::unique_ptr<Engine> make_engine(std::shared_ptr<gpu::GpuThread> thread, bool scatters) {
  return std::make_unique<GlEngine>(std::move(thread), scatters);
}

}  // namespace snowbough::snow::gl
