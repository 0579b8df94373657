#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "snow/repose/repose.h"

namespace snowbough::snow {

/// Repose on all receivers of a scene, on the processor's cores.
class ReposePass {
 public:
  /// A receiver's map in a step.
  struct Map {
    /// Number of its object in drawing order.
    size_t object = 0;
    std::vector<float>* height = nullptr;
    /// Out: what fell off it, in m3.
    double slid = 0.0;
    /// Out: whether heights changed.
    bool has_changed = false;
  };

  /// Bytes that repose takes at most, where snow lies all over these objects.
  static int64_t memory(const std::vector<const SceneObject*>& objects);

  /// `objects` must live until the next call.
  void lay_out(const std::vector<const SceneObject*>& objects);
  void forget_pose(size_t object);

  /// Moves what is steeper than the settings allow on these maps. `dt`: seconds that the step
  /// takes; a longer one may go on for longer until all rests.
  void run(const ReposeSettings& settings, float dt, std::vector<Map>& maps);

 private:
  void run_map(Map& map, float dt, bool on_all_cores);

  /// By object; null for what does not receive.
  std::vector<std::unique_ptr<Repose>> receivers_;
};

}  // namespace snowbough::snow
