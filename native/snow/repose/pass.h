#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "snow/repose/repose.h"

namespace snowbough::snow {

/// Repose on all receivers of a scene, on the CPU's cores.
class ReposePass {
 public:
  /// A receiver's map in a step.
  struct Map {
    /// Index of its object in drawing order.
    size_t object = 0;
    std::vector<float>* height = nullptr;
    /// Out: volume that fell off, in m3.
    double slid = 0.0;
    /// Out: whether heights changed.
    bool has_changed = false;
  };

  /// Maximum memory of repose in bytes, if snow covers these objects.
  static int64_t memory(const std::vector<const SceneObject*>& objects);

  /// `objects` must live until the next call.
  void lay_out(const std::vector<const SceneObject*>& objects);
  void forget_pose(size_t object);

  /// Moves snow that is steeper than the settings allow on these maps. `dt`: duration of the step
  /// in seconds; a longer step may run more rounds until all snow rests.
  void run(const ReposeSettings& settings, float dt, std::vector<Map>& maps);

 private:
  void run_map(Map& map, float dt, bool on_all_cores);

  std::unique_ptr<ReposeLinkTables> link_tables_;
  /// By object; null for objects that do not receive.
  std::vector<std::unique_ptr<Repose>> receivers_;
};

}  // namespace snowbough::snow
