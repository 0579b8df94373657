#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "shaders/lib/snow_shared.h"
#include "snow/movement/moving_map.h"
#include "snow/scene/memory_estimate.h"
#include "snow/scene/projection.h"
#include "snow/scene/scene_layout.h"
#include "snow/scene/triangle_range.h"
#include "snow/step/engine/engine_request.h"

namespace snowbough::gpu {
struct ThreadTexture;
}  // namespace snowbough::gpu

namespace snowbough::snow {

struct SeamTable;

/// How much snow a slope holds.
struct StabilitySettings {
  /// Thickness in metres that level ground holds; a slope holds max_depth * (normal . up).
  float max_depth = 1.0f;
  /// Seconds in which the snow beyond the capacity halves.
  float half_life = 2.0f;
  /// Fraction of max_depth that walls and undersides hold, too; 0: nothing sticks to them.
  float adhesion = 0.0f;
  /// Whether to record what slides off each texel, for MovingMap::slid_from.
  bool records_slid = false;

  /// Half-life, clamped to at least 1 microsecond.
  float clamped_half_life() const { return half_life < 1e-6f ? 1e-6f : half_life; }
  /// The least upward part of a normal for the capacity.
  float least_up() const { return adhesion > 0.0f ? adhesion : -2.0f; }
};

/// Takes what masks, pressing objects, thaw and wind have removed from a map out of its balance.
inline void count_removed(const MovingMap& map, shared::ObjectSums& sums) {
  // Stability, which sums what is held, finds the snow melted, or drifted.
  sums.held -= map.masked + map.pressed + map.cleared;
  sums.removed += map.removed();
  sums.total_masked += map.masked;
  sums.total_pressed += map.pressed;
  sums.total_cleared += map.cleared;
  sums.total_melted += map.melted;
  sums.total_drifted += map.drifted;
}

/// Total cost of a pass's calls.
struct PassCost {
  std::string name;
  int32_t calls = 0;
  /// Seconds by the GPU's clock.
  double gpu_seconds = 0.0;
  /// Seconds to submit the pass and, on a software renderer, to run it.
  double wall_seconds = 0.0;
};

/// Gain of a texel in a step; see shared::TexelStep.
struct TexelGain {
  /// row * resolution + column.
  uint32_t place = 0;
  uint32_t gain = 0;
};

/// Runs the passes of a step: as OpenGL shaders (step/gl) or as C++ on the CPU's cores (step/cpu).
/// Chosen once, when a simulation is made. The frame step calls the passes, one function each, in
/// the order below. `object` is an index into the objects sorted by name. Same input, same engine,
/// same driver: same bits.
class Engine {
 public:
  virtual ~Engine() = default;

  virtual EngineKind kind() const = 0;
  /// Everything that can change the last bits of a result: renderer and version, or the CPU build.
  virtual std::string driver() const = 0;
  /// Free memory in bytes for a scene; 0 = unknown.
  virtual int64_t free_memory() = 0;
  /// Bytes that a scene of these objects will take, without the passes that move snow.
  /// `tile_size`: see FrameStep.
  virtual MemoryEstimate memory(const std::vector<const SceneObject*>& objects,
                                int32_t tile_size) const = 0;

  /// Calls `work` on the thread on which all functions below are called. Throws as `work`.
  virtual void run(const std::function<void()>& work) = 0;

  /// Builds the scene with bare maps and without positions. `objects` are sorted by name and must
  /// live until the next call.
  virtual void build_scene(const std::vector<const SceneObject*>& objects) = 0;
  virtual void set_positions(size_t object, const std::vector<glm::vec3>& positions) = 0;

  /// Evaluates every triangle as seen along the step's fall.
  virtual void set_up_triangles(const shared::ProjectionFrame& frame) = 0;
  /// Selects the groups of texels that are active in this step.
  virtual void choose_texels() = 0;
  /// Sets the step's sums to zero.
  virtual void open_statistics() = 0;
  /// Evaluates area and slope of the active texels, for steps without snowfall.
  virtual void evaluate_texels() = 0;
  /// Renders the surfaces that the sky sees in a tile and its margin. `ranges` are drawn in order.
  virtual void render_occlusion(const Tile& tile, const std::vector<TriangleRange>& ranges) = 0;
  /// Counts the tile's pixels in which the sky sees back faces.
  virtual void count_back_faces(const Tile& tile) = 0;
  /// Gathers the deposit of the active texels in the tile. `is_first`: the step's first tile.
  virtual void gather_deposit(const Tile& tile, bool is_first) = 0;
  /// Adds the deposit to the heights and lets snow beyond a slope's capacity slide. `full_gain`:
  /// thickness in metres of a fully visible texel that faces the fall; `dt` in seconds.
  virtual void apply_stability(const StabilitySettings& settings, float full_gain, float dt) = 0;
  /// Calls `move` with all receivers' stored heights in main memory, in the order of their objects,
  /// and takes back the maps that it marks as changed. Snow that left a map counts as slid, snow
  /// that came to one as landed.
  virtual void move_snow(const std::function<void(std::vector<MovingMap>&)>& move) = 0;
  /// Updates sums and totals. `pixel_area` in m2.
  virtual void close_statistics(float pixel_area) = 0;

  /// A receiver's stored heights, resolution x resolution.
  virtual void read_height(size_t object, std::vector<float>& height) = 0;
  virtual void write_height(size_t object, const std::vector<float>& height) = 0;
  /// A receiver's output as a texture, computed on the GPU that holds the heights (see LiveFilter).
  /// The first call builds its tables, which depend on `blur_radius` (metres). Null for engines
  /// without it.
  virtual std::shared_ptr<const gpu::ThreadTexture> live_output(size_t /*object*/,
                                                                const SceneObject& /*receiver*/,
                                                                const SeamTable& /*seams*/,
                                                                double /*blur_radius*/) {
    return nullptr;
  }
  /// Starts or stops measuring passes; only for engines on a GPU.
  virtual void measure_passes(bool /*on*/) {}
  /// Costs measured since the last call, in the order of the passes' first run. Waits for the GPU.
  virtual std::vector<PassCost> take_costs() { return {}; }
  /// Data of the current step, for hashes (step/pass_hashes.h): triangles as seen along the fall,
  /// the pixels of the last tile, and, for engine CPU, the gains over 0 of a receiver's texels
  /// after apply_stability.
  virtual std::vector<glm::vec4> read_triangles(const TriangleRange& /*range*/) { return {}; }
  virtual std::vector<shared::SeenPixel> read_occlusion(const Tile& /*tile*/) { return {}; }
  virtual std::vector<TexelGain> read_gains(size_t /*object*/) { return {}; }
  /// A receiver's balance.
  virtual shared::ObjectSums read_sums(size_t object) = 0;
  virtual void write_sums(size_t object, const shared::ObjectSums& sums) = 0;

  /// Layout of the current scene.
  virtual const SceneLayout& layout() const = 0;
};

}  // namespace snowbough::snow
