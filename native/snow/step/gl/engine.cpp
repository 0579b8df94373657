#include "snow/step/gl/engine.h"

#include <algorithm>
#include <map>
#include <utility>

#include "gpu/timer.h"
#include "snow/output/gl/live_filter.h"
#include "snow/step/gl/driver.h"
#include "snow/step/gl/occlusion.h"
#include "snow/step/gl/passes.h"
#include "snow/step/gl/repose.h"
#include "snow/step/gl/scene_buffers.h"

namespace snowbough::snow::gl {
namespace {

/// All GPU objects of a simulation; created, used and destroyed on its thread.
struct Passes {
  SceneBuffers scene;
  TriangleSetupPass triangles;
  TexelGroupsPass groups;
  TexelSurfacePass surface;
  OcclusionPass occlusion;
  BackPixelsPass back_pixels;
  DepositPass deposit;
  /// Created on first use.
  std::unique_ptr<DepositGeometryPass> deposit_geometry;
  StabilityPass stability;
  StatisticsPass statistics;
  std::vector<const SceneObject*> objects;
  /// Created on first use.
  std::unique_ptr<ReposePass> repose;
  OcclusionTarget target;
  /// By object.
  std::map<size_t, std::unique_ptr<LiveFilter>> live_filters;
  gpu::PassTimer timer{gpu::renders_in_software()};
  gpu::Buffer projection{static_cast<int64_t>(sizeof(shared::ProjectionFrame))};
  bool has_noise = false;
};

class GlEngine final : public Engine {
 public:
  GlEngine(std::shared_ptr<gpu::GpuThread> thread, DepositMapping mapping)
      : thread_(std::move(thread)), by_geometry_(mapping == DepositMapping::kGeometry) {}
  ~GlEngine() override {
    if (passes_ == nullptr) return;
    if (thread_->is_in_this_process()) {
      thread_->run([this] { passes_.reset(); });
    } else {
      static_cast<void>(passes_.release());
    }
  }
  GlEngine(const GlEngine&) = delete;
  GlEngine& operator=(const GlEngine&) = delete;

  EngineKind kind() const override { return EngineKind::kGl; }
  std::string driver() const override {
    return thread_->info().renderer + ", " + thread_->info().version;
  }
  int64_t free_memory() override { return available_memory(thread_->info()); }
  int32_t max_layers() const override { return thread_->info().max_array_layers; }
  void run(const std::function<void()>& work) override { thread_->run(work); }

  void build_scene(const std::vector<const SceneObject*>& objects) override {
    if (passes_ == nullptr) {
      passes_ = std::make_unique<Passes>();
      passes_->timer.set_enabled(measures_);
    }
    passes_->scene = SceneBuffers{};
    passes_->live_filters.clear();
    passes_->repose.reset();
    passes_->scene = build_scene_buffers(objects, thread_->info(), by_geometry_);
    passes_->objects = objects;
  }
  void set_positions(size_t object, const std::vector<glm::vec3>& positions) override {
    passes_->scene.positions.write(int64_t{12} * layout().first_vertex[object],
                                   static_cast<int64_t>(positions.size()) * 12, positions.data());
    passes_->scene.normals_are_current = false;
    if (passes_->repose != nullptr) passes_->repose->forget_pose(object);
  }

  void set_up_triangles(const shared::ProjectionFrame& frame) override {
    passes_->has_noise = shared::noise_density(frame) < 1.0f;
    passes_->projection.write(0, sizeof frame, &frame);
    const auto measured = passes_->timer.measure("triangles");
    passes_->triangles.run(passes_->scene, passes_->projection);
  }
  void choose_texels() override {
    const auto measured = passes_->timer.measure("texel groups");
    // GEOMETRY processes all texels.
    passes_->groups.run(passes_->scene, by_geometry_);
  }
  void open_statistics() override {
    const auto measured = passes_->timer.measure("statistics");
    passes_->statistics.open(passes_->scene);
  }
  void evaluate_texels() override {
    const auto measured = passes_->timer.measure("texels");
    evaluate_surface();
  }
  void render_occlusion(const Tile& tile, const std::vector<TriangleRange>& ranges) override {
    const auto measured = passes_->timer.measure("occlusion");
    passes_->occlusion.run(passes_->scene, passes_->projection, tile, ranges, passes_->target);
  }
  void count_back_faces(const Tile& tile) override {
    const auto measured = passes_->timer.measure("back faces");
    passes_->back_pixels.run(passes_->scene, tile, passes_->target);
  }
  void gather_deposit(const Tile& tile, bool is_first) override {
    const auto measured = passes_->timer.measure("deposit");
    if (!by_geometry_) {
      passes_->deposit.run(passes_->scene, passes_->projection, tile, passes_->target,
                           passes_->has_noise, is_first);
      return;
    }
    if (is_first) evaluate_surface();
    passes_->deposit_geometry->run(passes_->scene, passes_->projection, tile, passes_->target);
  }
  void apply_stability(const StabilitySettings& settings, float full_gain, float dt) override {
    const auto measured = passes_->timer.measure("stability");
    passes_->stability.run(passes_->scene, settings, full_gain, dt, by_geometry_);
  }
  void apply_repose(const ReposeSettings& settings, float dt) override {
    if (!settings.is_on() || !(dt > 0.0f)) return;
    const auto measured = passes_->timer.measure("repose");
    if (passes_->repose == nullptr) {
      passes_->repose =
          std::make_unique<ReposePass>(passes_->objects, passes_->scene, thread_->info());
    }
    passes_->repose->run(passes_->scene, settings, dt);
  }
  void close_statistics(float pixel_area) override {
    const auto measured = passes_->timer.measure("statistics");
    passes_->statistics.close(passes_->scene, pixel_area);
  }

  void read_height(size_t object, std::vector<float>& height) override {
    group_of(object).read_height(layer_of(object), height);
  }
  void write_height(size_t object, const std::vector<float>& height) override {
    group_of(object).write_height(layer_of(object), height);
    TexelGroupsPass::forget(passes_->scene);
  }
  std::shared_ptr<const gpu::ThreadTexture> live_output(size_t object, const SceneObject& receiver,
                                                        const SeamTable& seams,
                                                        double blur_radius) override {
    std::unique_ptr<LiveFilter>& filter = passes_->live_filters[object];
    if (filter == nullptr) {
      filter = std::make_unique<LiveFilter>(thread_, *receiver.table, seams, blur_radius);
    }
    const auto measured = passes_->timer.measure("output");
    group_of(object).height.copy_to(layer_of(object), GL_RED, GL_FLOAT, filter->map());
    return std::make_shared<const gpu::ThreadTexture>(filter->run());
  }
  void measure_passes(bool on) override {
    measures_ = on;
    if (passes_ != nullptr) passes_->timer.set_enabled(on);
  }
  std::vector<PassCost> take_costs() override {
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
  std::vector<glm::vec4> read_triangles(const TriangleRange& range) override {
    const int64_t first = range.first, count = range.count;
    std::vector<glm::vec4> data(4 * static_cast<size_t>(count));
    passes_->scene.triangle_corners.read(48 * first, 48 * count, data.data());
    passes_->scene.triangle_surface.read(16 * first, 16 * count, data.data() + 3 * count);
    return data;
  }
  std::vector<shared::SeenPixel> read_occlusion(const Tile& tile) override {
    const glm::ivec2 size = tile.with_margin().size();
    std::vector<shared::SeenPixel> pixels(static_cast<size_t>(size.x) *
                                          static_cast<size_t>(size.y));
    passes_->target.visible.read(0, static_cast<int64_t>(pixels.size() * sizeof(shared::SeenPixel)),
                                 pixels.data());
    return pixels;
  }
  shared::ObjectSums read_sums(size_t object) override {
    shared::ObjectSums sums;
    passes_->scene.sums.read(sums_offset(object), sizeof sums, &sums);
    return sums;
  }
  void write_sums(size_t object, const shared::ObjectSums& sums) override {
    passes_->scene.sums.write(sums_offset(object), sizeof sums, &sums);
  }

  const SceneLayout& layout() const override { return passes_->scene.layout; }

 private:
  void evaluate_surface() {
    passes_->surface.run(passes_->scene);
    if (by_geometry_) begin_geometry();
  }
  void begin_geometry() {
    if (passes_->deposit_geometry == nullptr) {
      passes_->deposit_geometry = std::make_unique<DepositGeometryPass>();
    }
    passes_->deposit_geometry->begin(passes_->scene);
  }
  MapGroup& group_of(size_t object) {
    return passes_->scene.groups[static_cast<size_t>(layout().plan.group[object])];
  }
  int32_t layer_of(size_t object) {
    return layout().plan.slot[object] - group_of(object).first_slot;
  }
  int64_t sums_offset(size_t object) {
    return int64_t{layout().plan.slot[object]} * static_cast<int64_t>(sizeof(shared::ObjectSums));
  }

  std::shared_ptr<gpu::GpuThread> thread_;
  bool by_geometry_;
  bool measures_ = false;
  std::unique_ptr<Passes> passes_;
};

}  // namespace

std::unique_ptr<Engine> make_engine(std::shared_ptr<gpu::GpuThread> thread,
                                    DepositMapping mapping) {
  return std::make_unique<GlEngine>(std::move(thread), mapping);
}

}  // namespace snowbough::snow::gl
