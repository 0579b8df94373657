#pragma once

#include <string>
#include <vector>

#include "snow/scene/object_set.h"
#include "snow/state/checkpoint.h"
#include "snow/step/choose_engine.h"
#include "snow/step/frame_step.h"
#include "snow/step/pass_hashes.h"

namespace snowbough::snow {

/// The maps and sums of a simulation's objects on its engine. The engine's scene is built when a
/// step needs it; until then the maps wait in main memory. For one thread at a time.
class EngineScene {
 public:
  EngineScene(const EngineRequest& request, const ObjectSet& objects)
      : choice_(request), objects_(objects) {}

  /// Waits for the engine. @throws std::runtime_error if it is not available.
  Engine& engine() { return choice_.engine(); }
  /// Why this engine was chosen.
  const std::string& reason() const { return choice_.reason(); }
  /// Whether the engine holds the maps.
  bool is_current() const { return is_current_; }

  /// Bytes that a step will take.
  MemoryEstimate memory(int32_t tile_size, bool moves_snow);
  /// Runs a step on the objects' positions. AUTO continues on the CPU if GL fails in its first
  /// step.
  void run_step(const FrameStep& step);
  /// Copies the maps and sums to main memory. Call it before the set of objects changes.
  void set_aside();
  /// Removes the snow of a receiver that is replaced, where the new table has no texels.
  void keep_owned(const SceneObject& replacement);

  /// A receiver's stored heights; `height` has its size.
  void read_height(const std::string& receiver, std::vector<float>& height);
  shared::ObjectSums read_sums(const std::string& receiver);
  /// See Movement::take_flying.
  std::vector<FlyingSnow> take_flying() { return movement_.take_flying(); }
  /// A receiver's water in metres by place.
  std::vector<float> water(const std::string& receiver);
  LandingState landing() const { return is_current_ ? movement_.landing() : pending_.landing; }
  /// Without the step's number.
  SimulationState state();
  /// @throws std::invalid_argument naming the difference, or for heights or sums that are not
  /// finite.
  void set_state(const SimulationState& state);

  /// Starts or stops hashing the passes of each step.
  void hash_passes(bool on) { hashes_passes_ = on; }
  std::vector<PassHash> take_hashes() { return std::exchange(hashes_, {}); }

 private:
  void build(const FrameStep& step);
  void run_on(Engine& engine, const FrameStep& step);
  const ObjectState* pending(const std::string& receiver) const;
  void write_state(const SimulationState& state);

  EngineChoice choice_;
  const ObjectSet& objects_;
  Movement movement_;
  bool is_current_ = false;
  bool hashes_passes_ = false;
  std::vector<PassHash> hashes_;
  /// State that waits for the engine's scene: applied when the scene is built, and kept until that
  /// engine has finished a step.
  SimulationState pending_;
};

}  // namespace snowbough::snow
