#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "snow/movement/flying.h"
#include "snow/receiver_outputs.h"
#include "snow/scene/memory_estimate.h"
#include "snow/scene/object_set.h"
#include "snow/scene/snow_mask.h"
#include "snow/scene/statistics.h"
#include "snow/simulation_settings.h"
#include "snow/state/checkpoint.h"
#include "snow/step/engine/engine.h"
#include "snow/step/pass_hashes.h"

namespace snowbough::snow {

class EngineScene;

/// The engine of a simulation.
struct EngineInfo {
  /// "GL" or "CPU".
  std::string name;
  /// Everything that can change the last bits of a result: renderer and version, or the CPU build.
  std::string driver;
  /// Why this engine was chosen: a sentence without its full stop.
  std::string reason;
};

/// Simulates snow that accumulates on moving objects: the objects (ObjectSet), their maps on an
/// engine (EngineScene) and their output (ReceiverOutputs) behind one lock, so that calls from
/// several threads run one at a time.
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
  /// have been given once. Objects in `hidden` keep their snow, gain none and block none in this
  /// step. `depth`: metres on open level ground, negative for snow that thaws there (MeltSettings);
  /// `direction`: of the fall and of rain, downwards, any length; `sun`: of its light, 0 without
  /// sun; `dt`: seconds for sliding and repose (0: no snow moves); `wind`: the horizontal direction
  /// in which snow drifts, any length, 0: it does not.
  /// @throws std::invalid_argument with the object's name for an unknown name, a vertex count that
  /// is too small or differs from the step before, or positions that are not finite.
  void step(const PositionMap& positions, double depth, const glm::dvec3& direction, double dt,
            const std::set<std::string>& hidden = {}, const glm::dvec3& sun = {},
            const glm::dvec2& wind = {});

  /// By receiver: what has begun to fly off it in the steps since the last call, with the setting
  /// `points`.
  std::map<std::string, std::vector<FlyingSnow>> take_flying();

  /// Applies other settings from the next step on; the snow stays. Numbers that cannot change (see
  /// NumberSetting), tile_size and engine keep their first values.
  /// @throws std::invalid_argument for settings out of range.
  void change_settings(const SimulationSettings& settings);
  const SimulationSettings& settings() const { return settings_; }
  /// Sets the standard deviation in metres of the blur of one receiver's output; the stored map
  /// stays.
  /// @throws std::invalid_argument for a name that is no receiver, and a radius that is negative or
  /// not finite.
  void set_blur_radius(const std::string& name, double blur_radius);

  /// Sets a receiver's mask from the next step on (movement/masks.h); an empty one removes it, as
  /// does replace_object.
  /// @throws std::invalid_argument for a name that is no receiver, and as texel_weights.
  void set_mask(const std::string& name, const SnowMask& mask);
  /// Sets the time in seconds in which half of a receiver's snow lets go, from the next step on
  /// (movement/shedding.h); 0: it stays.
  /// @throws std::invalid_argument for a name that is no receiver, and a negative time.
  void set_shed_half_life(const std::string& name, double half_life);
  /// Sets what an object does to the snow of others that it touches, from the next step on
  /// (movement/pressing.h).
  /// @throws std::invalid_argument for an unknown name, and settings out of range.
  void set_presser(const std::string& name, const PressSettings& settings);

  /// Stored thickness in metres, resolution x resolution, row 0 = v 0.
  std::vector<float> height(const std::string& name);
  /// The map as users see it: smoothed by blur_radius, extended by 4 texels beyond the charts, and
  /// level across seams. @throws std::invalid_argument before the object's first step.
  MapOutput output(const std::string& name);
  /// The input of `output` at this moment, for evaluation later, with other maps on request.
  /// @throws std::invalid_argument before the object's first step.
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
  SnowStatistics statistics();
  /// Memory of the next step; waits for the engine.
  MemoryEstimate memory_estimate();
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
  /// @throws std::runtime_error if closed.
  EngineScene& scene() const;
  std::vector<float> stored_height(const std::string& name);

  SimulationSettings settings_;
  mutable std::mutex mutex_;
  ObjectSet objects_;
  ReceiverOutputs outputs_;
  /// Null when closed.
  std::unique_ptr<EngineScene> scene_;
  uint32_t step_number_ = 0;
};

}  // namespace snowbough::snow
