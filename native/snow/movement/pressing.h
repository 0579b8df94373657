#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "snow/movement/flying.h"
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
  /// Whether snow should come to rest after this part: after the last one, and ahead of blades
  /// after every second one before it.
  bool rests() const;
  /// Moves the objects to the end of a part, from 1.
  void move_to(int part);
  /// Presses a map's snow. `slope`: of repose.
  void press(MovingMap& map, Repose& repose, double slope);
  /// The blocks of a map that a blade has changed since the last rest, ascending.
  std::vector<int32_t> ploughed_blocks(const MovingMap& map) const;
  /// Whether some of a map's snow is packed or touches an object.
  bool is_pressed(const MovingMap& map) const {
    const Pressed& own = pressed_[map.object];
    return !own.packed.empty() || !own.under.empty() || !own.is_ploughed.empty();
  }
  /// By texel: thickness in metres of a map's packed snow; empty: none is.
  const std::vector<float>& packed(const MovingMap& map) const {
    return pressed_[map.object].pressed_to;
  }
  /// The texels of a map under an object, ascending.
  const std::vector<int32_t>& under(const MovingMap& map) const {
    return pressed_[map.object].under;
  }
  /// By block of the map: whether packed snow stands there; empty: nowhere.
  std::vector<uint8_t> standing_blocks(const MovingMap& map, Repose& repose);
  /// Sets the height to which snow stands at each place of the map: packed snow, and snow under an
  /// object.
  void set_stand(const MovingMap& map, Repose& repose);
  /// Ends the step, of `dt` seconds. `flying`: takes what blades have thrown up; may be null.
  void end(uint32_t step_number, double dt, std::vector<FlyingSnow>* flying);

  void save(SimulationState& state) const;
  void save(size_t object, ObjectState& state) const;
  void load(const SimulationState& state);
  void load(size_t object, const ObjectState& state);

 private:
  /// A texel onto which snow lies along its unit normal; 0: not found yet.
  struct Column {
    int32_t texel = 0;
    glm::dvec3 normal{0.0};
  };
  /// Neighbouring ones, found when needed, and a box around them up to the thickest snow.
  struct Columns {
    size_t run = 0;
    Bounds box;
    std::vector<Column> columns = {};
    bool is_found = false;
  };
  /// What a receiver keeps.
  struct Pressed {
    /// World positions of the texels; boxes around runs of them; and around runs of these. Empty if
    /// not current.
    std::vector<glm::vec3> points;
    std::vector<Bounds> runs, long_runs;
    /// By run: the least upward part of its texels' normals.
    std::vector<float> least_up;
    /// By object: the texels that it may touch in this step; and up to which thickness.
    std::vector<std::vector<Columns>> columns;
    double reach = 0.0;
    /// Edge of a texel in metres, on average.
    double texel_size = 0.0;
    /// By texel, empty before anything was pressed: metres of fresh snow that were packed away; the
    /// thickness after that; and the height to which it stands.
    std::vector<float> packed, pressed_to, stands;
    /// Texels under an object now, ascending; and blocks with packed snow, and that a blade has
    /// changed.
    std::vector<int32_t> under;
    /// See PressedMap::numbers.
    std::vector<int32_t> numbers;
    std::vector<uint8_t> has_packed, is_ploughed;
    /// By place: what set_stand has set, and whether it is under an object; and the blocks where it
    /// is not 0. Empty before its first call.
    std::vector<float> stand;
    std::vector<uint8_t> is_under, stands_in;
    /// The thickest snow, in metres.
    double deepest = 0.0;

    float stand_at(int32_t texel, float height) const;
    glm::dvec3 most_around(float up) const;
  };
  struct Touched;
  void find_points(size_t object);
  static void find_packed(Pressed& own, const SceneObject& object, const ReposeLinks& links);
  void find_columns(size_t presser, const PressedMap& map);
  void fill_columns(size_t presser, const PressedMap& map, Columns& columns) const;
  std::vector<Touched> touched_by(size_t presser, const PressedMap& map);
  void press_with(size_t presser, MovingMap& map, PressedMap& pressed, double slope);
  void throw_up(size_t presser, const PressedMap& map, const std::vector<PushedSnow>& pushed);
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
  int part_ = 1;
  int parts_ = 1;
  bool any_blade_ = false;
  bool has_ploughed_ = false;
  /// Snow that a blade pushes in a cube of space in this step: sums weighted by volume, of the way
  /// in m per step.
  struct Thrown {
    int32_t object = 0;
    double volume = 0.0;
    glm::dvec3 point{0.0}, way{0.0};
  };
  std::map<std::array<int64_t, 3>, Thrown> thrown_;
};

}  // namespace snowbough::snow
