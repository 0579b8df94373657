#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gpu/gpu_thread.h"
#include "gpu/program.h"
#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "gpu/timer.h"
#include "snow/output/gl/live_filter.h"
#include "snow/scene/projection.h"
#include "snow/step/engine/engine.h"
#include "snow/step/gl/driver.h"
#include "snow/step/gl/geometry/geometry_deposit.h"
#include "snow/step/gl/occlusion.h"
#include "snow/step/gl/scene_buffers.h"

// The passes of a step as shaders, in their order, and the engine that runs them. The OcclusionPass
// in step/gl/occlusion.h draws the surfaces that the sky sees. Each pass has a source and a shader
// of its name.
namespace snowbough::snow {

/// Evaluates every triangle on the current vertices as seen along this step's fall: corners in grid
/// pixels with depth, slopes, area; then the smooth points. It runs first; all other passes read
/// its result instead of the vertices.
class TriangleSetupPass {
 public:
  /// Fills the scene's `triangle_corners` and `triangle_surface` (shaders/lib/triangle_setup.h) and
  /// its `smooth_points`. `projection` holds the ProjectionFrame. GPU thread.
  void run(SceneBuffers& scene, const gpu::Buffer& projection);

 private:
  void find_smooth_points(SceneBuffers& scene, const gpu::Buffer& projection);

  gpu::Program program_{{"triangle_setup.comp.glsl"}};
  gpu::ProgramVariants points_{{"smooth_points.comp.glsl"}};
};

/// Selects the groups of texels that the passes of a step process: groups that hold snow or have a
/// triangle that faces the fall. On a solid body that is about half; the passes would change
/// nothing in the others.
class TexelGroupsPass {
 public:
  /// Fills the batches' `active_groups` from the triangles of this step's TriangleSetupPass. `all`
  /// selects every group. GPU thread.
  void run(SceneBuffers& scene, bool all);

  /// Marks all groups as holding snow: for maps that were written from outside. GPU thread.
  static void forget(SceneBuffers& scene);

  /// Marks the groups onto which snow has moved. GPU thread.
  void find_snow(SceneBuffers& scene);

 private:
  gpu::Program groups_{{"texel_groups.comp.glsl"}};
  gpu::Program snow_{{"snow_groups.comp.glsl"}};
};

/// Evaluates covered area and upward parts of the texels on the current triangles. Only for steps
/// without DepositPass, which does the same.
class TexelSurfacePass {
 public:
  /// Fills in `area`, `up` and `back_up` of the batches' `steps`, in their `active_groups`. GPU
  /// thread.
  void run(SceneBuffers& scene);

 private:
  gpu::ProgramVariants programs_{{"texel_surface.comp.glsl"}};
};

/// Counts, per receiver, the pixels in which the sky sees back faces of surfaces that gather
/// nothing: a high count suggests flipped normals.
class BackPixelsPass {
 public:
  /// `local_size`: at most shared::kMaxLocalSize. GPU thread.
  explicit BackPixelsPass(int32_t local_size = snow::local_size())
      : program_({"back_pixels.comp.glsl"}, {local_size_define(local_size)}) {}

  /// Adds a tile's own pixels to the scene's `back_pixels`. GPU thread.
  void run(SceneBuffers& scene, const Tile& tile, const OcclusionTarget& occlusion);

 private:
  gpu::Program program_;
};

/// Gathers the deposit of a tile at the texels. A texel gains
///
///   depth / max(|d.z|, 0.01) * sum over its fragments of (area * |n . d| * seen) / its area
///
/// where `seen` is the part of the pixels around the fragment that show nothing in front of the
/// fragment's plane (shaders/lib/visibility.h, shaders/lib/texel_gain.h). No pixel distributes snow
/// and no sum is kept per pixel: an evenly lit surface is covered evenly, and geometry thinner than
/// a pixel gets its own share. Differs on purpose from the scatter of Algorithm 1 in D. T.
/// Reynolds, Real-Time Rendering and Simulation of Trees and Snow, 2014, which is
/// GeometryDeposit.
class DepositPass {
 public:
  /// Adds the texels' gain in the tile to `gain` of the batches' `steps`, or sets it in the step's
  /// first tile, and fills their `area`, `up` and `back_up`. `occlusion` shows the tile. GPU
  /// thread.
  void run(SceneBuffers& scene, const gpu::Buffer& projection, const Tile& tile,
           const OcclusionTarget& occlusion, bool has_noise, bool is_first);

 private:
  gpu::ProgramVariants programs_{{"deposit.comp.glsl"}};
};

/// Adds the step's deposit (`gain` of the batches' `steps`) to the height maps and lets snow beyond
/// the slope's capacity slide, in closed form over `dt` seconds. Writes the volumes to the batches'
/// `partials`, one per invocation: `local_size` per work group of texels.
class StabilityPass {
 public:
  /// `local_size`: at most shared::kMaxLocalSize. GPU thread.
  explicit StabilityPass(int32_t local_size = snow::local_size()) : local_size_(local_size) {}

  /// `full_gain`: thickness in metres of a texel that gains shared::kGainUnits. `in_metres`: `gain`
  /// holds the bits of metres instead, negative on backs. GPU thread.
  void run(SceneBuffers& scene, const StabilitySettings& settings, float full_gain, float dt,
           bool in_metres = false);

 private:
  int32_t local_size_;
  gpu::ProgramVariants programs_{{"stability.comp.glsl"}};
};

/// Keeps every receiver's balance on the GPU, so that no step waits for a read.
class StatisticsPass {
 public:
  /// `local_size`: the stability pass's. GPU thread.
  explicit StatisticsPass(int32_t local_size = snow::local_size())
      : sums_({"statistics.comp.glsl"}, {local_size_define(local_size)}) {}

  /// Sets the step's sums to zero; before the deposit. GPU thread.
  void open(SceneBuffers& scene);
  /// Adds up the stability pass's work groups and updates the totals. `pixel_area` in m2. GPU
  /// thread.
  void close(SceneBuffers& scene, float pixel_area);

 private:
  gpu::Program sums_;
  gpu::Program open_{{"statistics_step.comp.glsl"}, {"OPENING"}};
  gpu::Program close_{{"statistics_step.comp.glsl"}};
};

namespace gl {

/// All GPU objects of a simulation; created, used and destroyed on its thread.
struct Passes {
  SceneBuffers scene;
  TriangleSetupPass triangles;
  TexelGroupsPass groups;
  TexelSurfacePass surface;
  OcclusionPass occlusion;
  BackPixelsPass back_pixels;
  DepositPass deposit;
  /// Only of an engine that scatters.
  std::unique_ptr<GeometryDeposit> geometry;
  StabilityPass stability;
  StatisticsPass statistics;
  std::vector<const SceneObject*> objects;
  OcclusionTarget target;
  /// By object.
  std::map<size_t, std::unique_ptr<LiveFilter>> live_filters;
  gpu::PassTimer timer{gpu::renders_in_software()};
  gpu::Buffer projection{static_cast<int64_t>(sizeof(shared::ProjectionFrame))};
  bool has_noise = false;
};

/// See make_engine (step/gl/engine.h).
class GlEngine final : public Engine {
 public:
  GlEngine(std::shared_ptr<gpu::GpuThread> thread, bool scatters)
      : thread_(std::move(thread)), by_geometry_(scatters) {}
  ~GlEngine() override;
  GlEngine(const GlEngine&) = delete;
  GlEngine& operator=(const GlEngine&) = delete;

  EngineKind kind() const override { return EngineKind::kGl; }
  std::string driver() const override {
    return thread_->info().renderer + ", " + thread_->info().version;
  }
  int64_t free_memory() override { return available_memory(thread_->info()); }
  MemoryEstimate memory(const std::vector<const SceneObject*>& objects,
                        int32_t tile_size) const override;
  void run(const std::function<void()>& work) override { thread_->run(work); }

  void build_scene(const std::vector<const SceneObject*>& objects) override;
  void set_positions(size_t object, const std::vector<glm::vec3>& positions) override;

  void set_up_triangles(const shared::ProjectionFrame& frame) override {
    passes_->has_noise = shared::noise_density(frame) < 1.0f;
    passes_->projection.write(0, sizeof frame, &frame);
    const auto measured = passes_->timer.measure("triangles");
    passes_->triangles.run(passes_->scene, passes_->projection);
  }
  void choose_texels() override {
    const auto measured = passes_->timer.measure("texel groups");
    // GeometryDeposit processes all texels.
    passes_->groups.run(passes_->scene, by_geometry_);
  }
  void open_statistics() override {
    const auto measured = passes_->timer.measure("statistics");
    passes_->statistics.open(passes_->scene);
  }
  void evaluate_texels() override {
    const auto measured = passes_->timer.measure("texels");
    passes_->surface.run(passes_->scene);
    if (by_geometry_) passes_->geometry->begin();
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
    if (by_geometry_ && is_first) evaluate_texels();
    const auto measured = passes_->timer.measure("deposit");
    if (by_geometry_) {
      passes_->geometry->run(passes_->scene, passes_->projection, tile, passes_->target);
    } else {
      passes_->deposit.run(passes_->scene, passes_->projection, tile, passes_->target,
                           passes_->has_noise, is_first);
    }
  }
  void apply_stability(const StabilitySettings& settings, float full_gain, float dt) override {
    const auto measured = passes_->timer.measure("stability");
    if (by_geometry_) passes_->geometry->write_gains(passes_->scene);
    records_slid_ = settings.records_slid;
    passes_->stability.run(passes_->scene, settings, full_gain, dt, by_geometry_);
  }
  void move_snow(const std::function<void(std::vector<MovingMap>&)>& move) override;
  void close_statistics(float pixel_area) override {
    const auto measured = passes_->timer.measure("statistics");
    passes_->statistics.close(passes_->scene, pixel_area);
  }

  void read_height(size_t object, std::vector<float>& height) override;
  void write_height(size_t object, const std::vector<float>& height) override;
  std::shared_ptr<const gpu::ThreadTexture> live_output(size_t object, const SceneObject& receiver,
                                                        const SeamTable& seams,
                                                        double blur_radius) override;
  void measure_passes(bool on) override;
  std::vector<PassCost> take_costs() override;
  std::vector<glm::vec4> read_triangles(const TriangleRange& range) override;
  std::vector<shared::SeenPixel> read_occlusion(const Tile& tile) override;
  shared::ObjectSums read_sums(size_t object) override;
  void write_sums(size_t object, const shared::ObjectSums& sums) override;
  const SceneLayout& layout() const override { return passes_->scene.layout; }

 private:
  void collect_slid(std::vector<MovingMap>& maps);
  MapGroup& group_of(size_t object);
  int32_t layer_of(size_t object);
  int64_t sums_offset(size_t object) const;

  std::shared_ptr<gpu::GpuThread> thread_;
  bool by_geometry_;
  bool measures_ = false;
  /// Whether the step's stability recorded what slid.
  bool records_slid_ = false;
  std::unique_ptr<Passes> passes_;
};

}  // namespace gl
}  // namespace snowbough::snow
