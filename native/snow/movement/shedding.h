#pragma once

#include <cstdint>
#include <vector>

#include "snow/movement/moving_map.h"
#include "snow/movement/repose/repose.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// Lets snow go from leaves and boughs (SceneObject::shed_half_life): all snow in a cube of
/// the rest pose, about as large as the snow is deep, at once, after a random time whose
/// distribution is exponential. How long snow has waited does not matter to such a time, so each
/// step draws new numbers and needs none of earlier steps. Landing moves on what falls.
class Shedding {
 public:
  /// `objects` must live until the next call.
  void lay_out(const std::vector<const SceneObject*>& objects);
  /// Whether any receiver lets snow go.
  bool is_on() const;
  /// Takes what lets go within `dt` seconds off a map; it counts as slid.
  void shed(uint32_t step_number, double dt, MovingMap& map, Repose& repose);

 private:
  std::vector<const SceneObject*> objects_;
};

}  // namespace snowbough::snow
