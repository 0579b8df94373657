#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "snow/output/map_memory.h"
#include "snow/output/map_output.h"
#include "snow/output/output_filter.h"
#include "snow/scene/memory_estimate.h"
#include "snow/scene/scene_object.h"
#include "snow/scene/statistics.h"
#include "snow/simulation_settings.h"
#include "snow/state/checkpoint.h"
#include "snow/step/engine/engine.h"
#include "snow/step/engine/engine_request.h"
#include "snow/step/pass_hashes.h"
#include "snow/texels/texel_tables.h"

namespace snowbough::snow {

class EngineChoice;

/// The engine of a simulation.
struct EngineInfo {
  /// "GL" or "CPU".
  std::string name;
  /// Everything that can change the last bits of a result: renderer and version, or the CPU build.
  std::string driver;
  /// Why this engine was chosen: a sentence without its full stop.
  std::string reason;
};

/// Vertex positions of each object in metres, by name.
using PositionMap = std::map<std::string, std::span<const glm::vec3>>;

/// A copy of a receiver's map at one moment. Its output can be computed on any thread while the
/// simulation continues, and after it is closed.
class OutputSnapshot {
 public:
  int32_t resolution() const { return resolution_; }
  /// See SnowSimulation::output. @throws std::runtime_error on a second call.
  MapOutput output();
  /// Pool to which the memory of the output's heights is returned; may be null.
  const std::shared_ptr<MapMemory>& memory() const { return memory_; }

 private:
  friend class SnowSimulation;
  int32_t resolution_ = 0;
  std::vector<float> stored_;
  OutputSurface surface_;
  std::shared_ptr<OutputFilter> filter_;
  std::shared_ptr<MapMemory> memory_;
};

/// Simulates snow that accumulates on moving objects. Calls from several threads run one at a time.
class SnowSimulation {
 public:
  /// @throws std::invalid_argument for settings out of range, std::runtime_error if the requested
  /// engine is not available.
  explicit SnowSimulation(const SimulationSettings& settings);
  ~SnowSimulation();
  SnowSimulation(const SnowSimulation&) = delete;
  SnowSimulation& operator=(const SnowSimulation&) = delete;

  /// @throws std::invalid_argument for a name that is already in use, and as build_texel_table.
  void add_object(ObjectDescription description);

  /// Replaces an object's mesh. A receiver keeps its map, texel by texel, wherever the new mesh has
  /// a surface in UV space; snow elsewhere is removed, and the change of volume counts as
  /// stretching. The next step must give the object's positions. If it throws, the object is
  /// unchanged.
  /// @throws std::invalid_argument for an unknown name, another resolution, a receiver that becomes
  /// an occluder or the reverse, and as add_object.
  void replace_object(ObjectDescription description);

  /// Simulates one step of snowfall. `positions` holds the objects that moved; each object must
  /// have been given once. `depth`: metres on open level ground; `direction`: of the fall,
  /// downwards, any length; `dt`: seconds for sliding and repose (0: no snow moves).
  /// @throws std::invalid_argument with the object's name for an unknown name, a vertex count that
  /// is too small or differs from the step before, or positions that are not finite.
  void step(const PositionMap& positions, double depth, const glm::dvec3& direction, double dt);

  /// Applies other settings from the next step on; the snow stays. Numbers that cannot change (see
  /// NumberSetting), mapping, tile_size, engine and device keep their first values.
  /// @throws std::invalid_argument for settings out of range.
  void change_settings(const SimulationSettings& settings);
  const SimulationSettings& settings() const { return settings_; }
  /// Sets the standard deviation in metres of the blur of one receiver's output; the stored map
  /// stays.
  /// @throws std::invalid_argument for a name that is no receiver, and a radius that is negative or
  /// not finite.
  void set_blur_radius(const std::string& name, double blur_radius);

  /// Stored thickness in metres, resolution x resolution, row 0 = v 0.
  std::vector<float> height(const std::string& name);
  /// The map as users see it: smoothed by blur_radius, extended by 4 texels beyond the charts, and
  /// level across seams; with other maps on request. @throws std::invalid_argument before the
  /// object's first step.
  MapOutput output(const std::string& name, const MapRequest& maps = {});
  /// The input of `output` at this moment, for evaluation later. @throws std::invalid_argument
  /// before the object's first step.
  OutputSnapshot snapshot(const std::string& name, const MapRequest& maps = {});
  /// Nearly the same as a texture that the real-time renderer draws from, without reading the map
  /// back (see LiveFilter). The next call overwrites it. Null if the heights are not on a GPU: use
  /// `output`. @throws std::invalid_argument before the object's first step.
  std::shared_ptr<const gpu::ThreadTexture> live_output(const std::string& name);
  /// Starts building the tables that `output` of a receiver needs, on threads beside the next
  /// steps, and returns at once. Changes no result. @throws std::invalid_argument for a receiver
  /// that was added without its rest pose and has had no step yet.
  void prepare_output(const std::string& name);
  /// Area in m2 that each texel covers in the current pose; 0 outside the surface. @throws
  /// std::invalid_argument before the first step.
  std::vector<float> texel_area(const std::string& name);
  int32_t resolution(const std::string& name) const;
  std::vector<std::string> receivers() const;
  SnowStatistics statistics();
  MemoryEstimate memory_estimate() const;
  /// See Engine; both wait for it.
  void measure_passes(bool on);
  std::vector<PassCost> take_costs();
  /// Starts or stops hashing the passes of each step (step/pass_hashes.h), which reads all maps
  /// back.
  void hash_passes(bool on);
  /// The hashes since the last call.
  std::vector<PassHash> take_hashes();
  /// The engine and why it was chosen; waits for it.
  EngineInfo engine_info();

  /// The content of a checkpoint; positions are not part of it.
  SimulationState state();
  /// Restores a state of a simulation with the same receivers. @throws std::invalid_argument naming
  /// the difference, or for heights or sums that are not finite.
  void set_state(const SimulationState& state);

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
  /// Copies the maps and sums from the engine to pending_state_, before the set of objects changes.
  void set_state_aside();
  void set_positions(const PositionMap& positions);
  /// Rebuilds the engine's scene; the maps keep their content.
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
  /// Alpha masks of all objects so far: equal masks are stored once.
  std::vector<std::weak_ptr<const AlphaMask>> masks_;
  TexelTables tables_;
  OutputFilterCache outputs_;
  std::shared_ptr<MapMemory> map_memory_ = std::make_shared<MapMemory>();
  bool scene_is_current_ = false;
  uint32_t step_number_ = 0;
  bool hashes_passes_ = false;
  std::vector<PassHash> hashes_;
  /// State that waits for the engine's scene: applied when the scene is built, and kept until that
  /// engine has finished a step.
  SimulationState pending_state_;
};

}  // namespace snowbough::snow
