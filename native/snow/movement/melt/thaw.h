#pragma once

#include <memory>
#include <vector>

#include "snow/movement/melt/linked_runs.h"
#include "snow/movement/moving_map.h"
#include "snow/movement/repose/repose.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// Thaw and rain in a step.
struct MeltSettings {
  /// Thickness in metres of lying snow that open, level ground loses; and water in metres that rain
  /// brings there.
  double depth = 0.0;
  double rain = 0.0;
  /// The part of the thaw on open ground that comes from the sun; the rest comes from the air.
  double sun_share = 0.7;
  /// How uneven snow melts, from 0 on: patches, and faster beside bare ground.
  double unevenness = 0.25;
  /// Density of the snow in kg/m3.
  double density = 100.0;
  /// Whether to follow the water.
  bool is_wet = false;
  /// Water in metres that a surface soaks up before more runs off.
  double soak = 0.002;
  /// Distance in metres over which water soaks sideways in a second.
  double wet_spread = 0.05;
  /// Half-life in seconds of the water on bare ground under the open sky.
  double drying = 4.0;

  bool is_on() const { return depth > 0.0 || is_wet; }
};

/// Melts lying snow: the air everywhere, the sun where it shines. A texel loses
/// depth * (1 - sun_share + sun_share * light) * uneven * near_bare, where light is the sun's on
/// the surface relative to open level ground, uneven is a noise fixed to the object's rest pose,
/// and near_bare grows with the bare ground within a hand's breadth, which the sun warms. Melted
/// snow leaves as MovingMap::melted.
class Thaw {
 public:
  /// `objects` must live until the next call.
  void lay_out(const std::vector<const SceneObject*>& objects);

  /// Melts a map's snow. `light`: by place on the map, as above; null: no sun shines. Returns by
  /// texel the thickness in metres that has melted, until the next call; empty if none has, or if
  /// the settings are not wet.
  const std::vector<float>& melt(const MeltSettings& settings, const std::vector<float>* light,
                                 MovingMap& map, Repose& repose);
  /// A receiver's texels side by side.
  const LinkedRuns& runs_of(size_t object, Repose& repose);

 private:
  const std::vector<float>& noise_of(size_t object);

  std::vector<const SceneObject*> objects_;
  /// By object and texel, about -1 to 1; empty before it is needed.
  std::vector<std::vector<float>> noise_;
  std::vector<std::unique_ptr<LinkedRuns>> runs_;
  /// Of the last map; members to keep their memory.
  std::vector<float> melted_, bareness_;
};

}  // namespace snowbough::snow
