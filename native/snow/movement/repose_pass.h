#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "snow/movement/moving_map.h"
#include "snow/movement/outlet_targets.h"
#include "snow/movement/repose/repose.h"

namespace snowbough::snow {

/// Repose on all receivers of a scene, on the CPU's cores, for either engine.
class ReposePass {
 public:
  /// Maximum memory of repose in bytes, if snow covers these objects.
  static int64_t memory(const std::vector<const SceneObject*>& objects);

  /// `objects` must live until the next call.
  void lay_out(const std::vector<const SceneObject*>& objects);
  void forget_pose(size_t object);

  /// Moves snow that is steeper than the settings allow on these maps. `dt`: duration of the step
  /// in seconds; a longer step may run more rounds until all snow rests.
  void run(const ReposeSettings& settings, float dt, std::vector<MovingMap>& maps);

 private:
  OutletTargets targets_;
  std::unique_ptr<ReposeLinkTables> link_tables_;
  /// By object; null for objects that do not receive.
  std::vector<std::unique_ptr<Repose>> receivers_;
};

}  // namespace snowbough::snow
