#pragma once

#include <vector>

#include "snow/movement/moving_map.h"
#include "snow/movement/repose/repose.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// Receivers' masks (SceneObject::mask): a mask of m lets that part of what comes onto a texel
/// stay, and lets it hold m times the depth that level ground holds. Snow that lies there shrinks
/// with a mask that decreases. What masks refuse leaves the scene as MovingMap::masked.
class Masks {
 public:
  /// `objects` must live until the next call. Forgets the masks of earlier steps.
  void lay_out(const std::vector<const SceneObject*>& objects);
  /// Whether any mask acts in the next step.
  bool is_on() const;

  /// Before anything comes onto a map: remembers its heights.
  void begin(const MovingMap& map);
  /// After deposit and stability: removes what the mask refuses.
  void refuse(MovingMap& map, Repose& repose);
  /// After snow has moved: removes what exceeds the mask's part of `max_depth`, in metres.
  void limit(MovingMap& map, Repose& repose, float max_depth) const;

  /// A receiver's mask of the last step as a plane, resolution x resolution; empty: none.
  std::vector<float> state(size_t object) const;
  /// Null: none.
  void set_state(size_t object, const std::vector<float>* plane);

 private:
  bool acts_on(size_t object) const;

  std::vector<const SceneObject*> objects_;
  /// By object and texel: the mask of the last step, empty for 1; and the thickness at the start of
  /// this step.
  std::vector<std::vector<float>> last_;
  std::vector<std::vector<float>> lying_;
};

}  // namespace snowbough::snow
