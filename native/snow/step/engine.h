#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "shaders/lib/snow_shared.h"
#include "snow/repose/repose.h"
#include "snow/scene/projection.h"
#include "snow/scene/scene_layout.h"
#include "snow/scene/triangle_range.h"

namespace snowbough::gpu {
struct ThreadTexture;
}  // namespace snowbough::gpu

namespace snowbough::snow {

struct SeamTable;

/// What decides how much snow a slope holds.
struct StabilitySettings {
  /// Thickness in metres that level ground holds; a slope holds max_depth * (normal . up).
  float max_depth = 1.0f;
  /// Seconds in which what is too much halves.
  float half_life = 2.0f;

  /// The half-life that is reckoned with: so short a one is as good as none.
  float clamped_half_life() const { return half_life < 1e-6f ? 1e-6f : half_life; }
};

/// What the calls of a pass took together.
struct PassCost {
  std::string name;
  int32_t calls = 0;
  /// Seconds of the GPU's own clock.
  double gpu_seconds = 0.0;
  /// Seconds in which it was handed in and, on a software renderer, done.
  double wall_seconds = 0.0;
};

/// What makes the passes of a step: shaders of OpenGL (step/gl) or C++ on the processor's cores
/// (step/cpu). Chosen once, when a simulation is made; the frame step calls the passes, one verb
/// each, in the order in which they stand here. Objects are meant by their number in drawing order,
/// by name. Same input, same engine, same driver: same bits.
class Engine {
 public:
  virtual ~Engine() = default;

  /// "GL" or "CPU".
  virtual std::string name() const = 0;
  /// What decides about last bits: renderer and version, or the processor's build.
  virtual std::string driver() const = 0;
  /// Free memory in bytes for what a scene takes; 0 = unknown.
  virtual int64_t free_memory() = 0;
  /// Largest number of layers of one array of maps.
  virtual int32_t max_layers() const = 0;

  /// Calls `work` on the thread on which all of what follows is called. Throws what it throws.
  virtual void run(const std::function<void()>& work) = 0;

  /// Lays a scene out, maps bare and positions unknown. `objects` are sorted by name and must live
  /// until the next call.
  virtual void build_scene(const std::vector<const SceneObject*>& objects) = 0;
  virtual void set_positions(size_t object, const std::vector<glm::vec3>& positions) = 0;

  /// Evaluates every triangle as the step's fall meets it.
  virtual void set_up_triangles(const shared::ProjectionFrame& frame) = 0;
  /// Chooses the work groups of texels that have anything to do in this step.
  virtual void choose_texels() = 0;
  /// Sets the step's sums to zero.
  virtual void open_statistics() = 0;
  /// Evaluates area and slope of the chosen texels, in steps in which nothing falls.
  virtual void evaluate_texels() = 0;
  /// Renders what the sky sees on a tile and its margin. `ranges` are drawn in their order.
  virtual void render_occlusion(const Tile& tile, const std::vector<TriangleRange>& ranges) = 0;
  /// Counts the tile's pixels in which the sky sees back faces.
  virtual void count_back_faces(const Tile& tile) = 0;
  /// Gathers what falls on the chosen texels in the tile. `is_first`: of the step's tiles.
  virtual void gather_deposit(const Tile& tile, bool is_first) = 0;
  /// Adds the deposit to the heights and lets slide what slopes cannot hold. `full_gain`: thickness
  /// in metres of a texel that faces the fall and is seen as a whole; `dt` in seconds.
  virtual void apply_stability(const StabilitySettings& settings, float full_gain, float dt) = 0;
  /// Moves snow that is steeper than its angle of repose to lower neighbours, and counts what falls
  /// over rims as slid (snow/repose/repose.h). `dt` in seconds; 0: nothing moves.
  virtual void apply_repose(const ReposeSettings& settings, float dt) = 0;
  /// Brings sums and totals up to date. `pixel_area` in m2.
  virtual void close_statistics(float pixel_area) = 0;

  /// A receiver's stored heights, resolution x resolution.
  virtual void read_height(size_t object, std::vector<float>& height) = 0;
  virtual void write_height(size_t object, const std::vector<float>& height) = 0;
  /// A receiver's output as a texture, made where the heights lie (see LiveFilter): its tables in
  /// the first call, which `blur_radius` (metres) belongs to. Null where the engine has none.
  virtual std::shared_ptr<const gpu::ThreadTexture> live_output(size_t /*object*/,
                                                                const SceneObject& /*receiver*/,
                                                                const SeamTable& /*seams*/,
                                                                double /*blur_radius*/) {
    return nullptr;
  }
  /// Whether passes are measured from now on, where they run on a GPU.
  virtual void measure_passes(bool /*on*/) {}
  /// What was measured since the last call, in the order in which the passes came first. Waits for
  /// the GPU.
  virtual std::vector<PassCost> take_costs() { return {}; }
  /// A receiver's balance.
  virtual shared::ObjectSums read_sums(size_t object) = 0;
  virtual void write_sums(size_t object, const shared::ObjectSums& sums) = 0;

  /// Of the scene that was laid out last.
  virtual const SceneLayout& layout() const = 0;
};

}  // namespace snowbough::snow
