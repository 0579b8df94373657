#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "snow/output/map_memory.h"
#include "snow/output/map_output.h"
#include "snow/output/output_filter.h"
#include "snow/scene/memory_estimate.h"
#include "snow/scene/scene_object.h"
#include "snow/scene/statistics.h"
#include "snow/state/checkpoint.h"
#include "snow/step/choose_engine.h"
#include "snow/step/frame_step.h"

namespace snowbough::snow {

/// What stays the same over a simulation.
struct SimulationSettings {
  /// Edge of an occlusion pixel in metres.
  double pixel_size = 0.01;
  /// Probability, over 0 to 1, with which a pixel gets snow in a step; those that do get
  /// 1 / density as much.
  double noise_density = 1.0;
  /// Radians by which flakes stray from the direction of the fall, 0 to pi / 4.
  double flutter = 0.0;
  /// Metres that level ground holds before snow slides.
  double max_depth = 1.0;
  /// Seconds in which what is too much for a slope halves.
  double slide_half_life = 2.0;
  /// Radians from level that snow's own surface keeps before it moves to what lies lower, over 0 to
  /// pi / 2; pi / 2: it stays where it fell, also on walls.
  double repose = 65.0 / 180.0 * std::numbers::pi;
  /// Metres that a front of snow stands upright: what is shaded smooth and curves about as tightly
  /// as that, as twigs do, carries steeper snow. 0: it does not hold together.
  double cohesion = 0.0;
  /// Sigma in metres of the blur of `output`; the stored map stays sharp.
  double blur_radius = 0.0;
  uint32_t seed = 0;
  gl::DepositMapping mapping = gl::DepositMapping::kCompute;
  /// Largest edge of an occlusion tile in pixels: a power of two from 64 to 4096. It changes memory
  /// and speed, never the result.
  int32_t tile_size = 2048;
  /// Which engine does the passes; see EngineChoice.
  EngineKind engine = EngineKind::kAuto;
  /// Which EGL device, see gpu::GlContext.
  std::string device;
  /// Whether the constructor waits for the engine and throws where there is none; else the first
  /// call that needs it does, and objects come in while the driver is still being loaded.
  bool wait_for_gpu = true;
};

/// Which engine a simulation has.
struct EngineInfo {
  /// "GL" or "CPU".
  std::string name;
  /// What decides about last bits.
  std::string driver;
  /// Why this one: a sentence without its full stop.
  std::string reason;
};

/// Positions of one object, N of them, in metres.
using PositionMap = std::map<std::string, std::span<const glm::vec3>>;

/// A receiver's map at one moment. What the outside sees of it may be worked out on any thread
/// while the simulation goes on, and also when it is closed.
class OutputSnapshot {
 public:
  int32_t resolution() const { return resolution_; }
  /// See SnowSimulation::output. @throws std::runtime_error for a second call.
  MapOutput output();
  /// Takes back the memory of the output's heights when they are done with; may be null.
  const std::shared_ptr<MapMemory>& memory() const { return memory_; }

 private:
  friend class SnowSimulation;
  int32_t resolution_ = 0;
  std::vector<float> stored_;
  OutputSurface surface_;
  std::shared_ptr<OutputFilter> filter_;
  std::shared_ptr<MapMemory> memory_;
};

/// Snow that accumulates on moving objects. Calls from several threads are taken one at a time.
class SnowSimulation {
 public:
  /// @throws std::invalid_argument for settings out of range, std::runtime_error where the engine
  /// that is asked for is not to be had.
  explicit SnowSimulation(const SimulationSettings& settings);
  ~SnowSimulation();
  SnowSimulation(const SnowSimulation&) = delete;
  SnowSimulation& operator=(const SnowSimulation&) = delete;

  /// @throws std::invalid_argument for a name that is taken and for what build_texel_table refuses.
  void add_object(ObjectDescription description);

  /// Gives an object another mesh. A receiver keeps its map, texel by texel, wherever the new mesh
  /// has a surface in UV space; what lay where it has none goes, and the change of volume counts as
  /// stretching. The next step must name the object.
  /// The object stays as it was where it throws.
  /// @throws std::invalid_argument for a name that is not there, another resolution, a receiver
  /// that becomes none or the reverse, and for what add_object refuses.
  void replace_object(ObjectDescription description);

  /// Lets snow fall for one step. `positions` names the objects that moved; all must have been
  /// named once. `depth`: metres on open level ground; `direction`: of the fall, any length,
  /// downwards; `dt`: seconds, only for sliding and repose (0 = nothing moves).
  /// @throws std::invalid_argument with the object's name for an unknown name, a vertex count that
  /// is too small or not that of the step before, or positions that are not finite.
  void step(const PositionMap& positions, double depth, const glm::dvec3& direction, double dt);

  /// Takes other settings from the next step on; the snow stays. pixel_size, mapping, tile_size,
  /// engine and device stay what they were, whatever `settings` says.
  /// @throws std::invalid_argument for settings out of range.
  void change_settings(const SimulationSettings& settings);
  const SimulationSettings& settings() const { return settings_; }
  /// Another sigma, in metres, for the blur of a receiver's output; the stored map stays.
  /// @throws std::invalid_argument for no receiver, or what is not 0 or more.
  void set_blur_radius(const std::string& name, double blur_radius);

  /// Stored thickness in metres, resolution x resolution, row 0 = v 0.
  std::vector<float> height(const std::string& name);
  /// What the outside sees: smoothed by blur_radius, continued by 4 texels beyond the charts, level
  /// at seams; with normals in tangent space on request. Before the object's first step
  /// std::invalid_argument.
  MapOutput output(const std::string& name, bool with_normals);
  /// What `output` would give now, to be worked out later. Before the object's first step
  /// std::invalid_argument.
  OutputSnapshot snapshot(const std::string& name, bool with_normals);
  /// Much the same as a texture that the real-time renderer draws from, without reading the map
  /// back (see LiveFilter); the next call changes its content. Null where the heights do not lie on
  /// a GPU: `output` has them. Before the object's first step std::invalid_argument.
  std::shared_ptr<const gpu::ThreadTexture> live_output(const std::string& name);
  /// Begins with what `output` of a receiver needs to build first, in threads beside the next
  /// steps, and returns at once. Changes no result. @throws std::invalid_argument for a receiver
  /// that was added without its rest pose and has had no step yet.
  void prepare_output(const std::string& name);
  /// Area in m2 that every texel covers now; 0 where there is no surface. Before the first step
  /// std::invalid_argument.
  std::vector<float> texel_area(const std::string& name);
  int32_t resolution(const std::string& name) const;
  std::vector<std::string> receivers() const;
  SnowStatistics statistics();
  MemoryEstimate memory_estimate() const;
  /// See Engine; waits for it.
  void measure_passes(bool on);
  std::vector<PassCost> take_costs();
  /// What does the passes, and why; waits for it.
  EngineInfo engine_info();

  /// What a checkpoint holds; positions are not part of it.
  SimulationState state();
  /// Takes a state of a simulation with the same receivers. @throws std::invalid_argument naming
  /// what differs, or whose heights or sums are not finite.
  void set_state(const SimulationState& state);

  /// Writes a checkpoint. @throws std::runtime_error when the disk refuses.
  void save(const std::string& path);
  /// Takes a checkpoint of a simulation with the same settings, objects and (unless `any_driver`)
  /// driver. @throws std::runtime_error for a file that is none or is damaged,
  /// std::invalid_argument naming what differs.
  void restore(const std::string& path, bool any_driver);

  /// Releases everything. Further calls throw std::runtime_error.
  void close();

 private:
  const std::shared_ptr<SceneObject>& find_receiver(const std::string& name) const;
  /// The same, with positions. @throws std::invalid_argument before its first step.
  const std::shared_ptr<SceneObject>& find_stepped_receiver(const std::string& name) const;
  std::vector<float> stored_height(const std::string& name);
  std::vector<const SceneObject*> all_objects() const;
  MemoryEstimate estimate() const;
  void require_open() const;
  SceneObject make_object(ObjectDescription description);
  /// Takes the maps and sums off the engine, before the set of objects changes.
  void set_state_aside();
  void take_positions(const PositionMap& positions);
  /// Lays the engine's scene out anew; the maps keep their content.
  void build_scene();
  void step_on(Engine& engine, const FrameStep& step);
  double blur_radius_of(const SceneObject& receiver) const;
  Engine& engine();
  SimulationState read_state();
  void write_state(const SimulationState& state);
  size_t index_of(const std::string& name) const;
  /// @throws std::invalid_argument unless a receiver has that name and resolution.
  void check_map(const std::string& name, int32_t resolution) const;

  SimulationSettings settings_;
  mutable std::mutex mutex_;
  /// Null when closed.
  std::unique_ptr<EngineChoice> choice_;
  /// By name: the drawing order.
  std::map<std::string, std::shared_ptr<SceneObject>> objects_;
  /// Alpha masks of all objects so far, so that equal ones are held once.
  std::vector<std::weak_ptr<const AlphaMask>> masks_;
  OutputFilterCache outputs_;
  std::shared_ptr<MapMemory> map_memory_ = std::make_shared<MapMemory>();
  bool scene_is_current_ = false;
  uint32_t step_number_ = 0;
  /// Set before the engine has the scene: taken over when it is laid out, and kept until that
  /// engine has done a step.
  SimulationState pending_state_;
};

}  // namespace snowbough::snow
