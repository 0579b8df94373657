#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "snow/movement/moving_map.h"
#include "snow/movement/press/presser.h"
#include "snow/movement/press/push.h"
#include "snow/movement/repose/repose.h"
#include "snow/state/checkpoint.h"

namespace snowbough::snow {

/// Objects that press, plough or clear the snow of receivers (SceneObject::press) as they move from
/// pose to pose. Above each texel a ray along its normal finds the object; snow that reaches into
/// it is packed in place down to what carries, pushed to the nearest texels beside the object, or
/// removed. Walls of packed snow stand, until new snow has filled the print; nothing slides through
/// the object. Packed snow counts as MovingMap::pressed, in the volume that it had when fresh.
class Pressing {
 public:
  /// `objects` must live until the next call. Forgets what was pressed.
  void lay_out(const std::vector<const SceneObject*>& objects);
  void forget_pose(size_t object);
  /// Whether any object presses snow.
  bool is_on() const;

  /// Begins a step; returns into how many parts of equal time its motion is divided, at least 1.
  int begin(const std::vector<MovingMap*>& maps);
  /// Whether a blade has pushed snow since the last call of move_to.
  bool has_ploughed() const { return has_ploughed_; }
  /// Moves the objects to the end of a part, from 1.
  void move_to(int part);
  /// Presses a map's snow.
  void press(MovingMap& map, Repose& repose);
  /// The height in metres to which snow stands at each place of the map: packed snow, and snow
  /// under an object. Null if none does.
  const std::vector<float>* stand(const MovingMap& map);
  /// Ends the step.
  void end();

  void save(SimulationState& state) const;
  void save(size_t object, ObjectState& state) const;
  void load(const SimulationState& state);
  void load(size_t object, const ObjectState& state);

 private:
  /// What a receiver keeps.
  struct Pressed {
    /// World positions of the texels; and boxes around runs of them. Empty if not current.
    std::vector<glm::vec3> points;
    std::vector<Bounds> runs;
    /// Edge of a texel in metres, on average.
    double texel_size = 0.0;
    /// By texel, empty before anything was pressed: metres of fresh snow that were packed away; the
    /// thickness after that; and the height to which it stands.
    std::vector<float> packed, pressed_to, stands;
    /// Texels under an object now, ascending.
    std::vector<int32_t> under;
    std::vector<float> plane;
    /// The thickest snow, in metres.
    double deepest = 0.0;
  };
  struct Touched;
  void find_points(size_t object);
  std::vector<int32_t> texels_near(const Pressed& own, const PressedMap& map,
                                   const Bounds& box) const;
  void press_with(size_t presser, MovingMap& map, PressedMap& pressed);
  void sink(const PressSettings& settings, const std::vector<Touched>& touched, MovingMap& map,
            PressedMap& pressed, std::vector<PushedSnow>& pushed);

  std::vector<const SceneObject*> objects_;
  std::vector<Pressed> pressed_;
  /// By object; null for those that do not press.
  std::vector<std::unique_ptr<Presser>> pressers_;
  /// By object: whether it may touch snow in this step.
  std::vector<uint8_t> is_near_;
  /// By object that presses: positions of the last step; empty if it was not shown.
  std::vector<std::vector<glm::vec3>> last_;
  int parts_ = 1;
  bool has_ploughed_ = false;
};

}  // namespace snowbough::snow
