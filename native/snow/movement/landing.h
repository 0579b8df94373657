#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "snow/movement/flying.h"
#include "snow/movement/moving_map.h"
#include "snow/movement/rays/map_point.h"
#include "snow/movement/rays/scene_rays.h"
#include "snow/movement/repose/repose.h"
#include "snow/state/checkpoint.h"

namespace snowbough::snow {

/// Volume in m3 of the unit in which falling snow is counted: 2^-44.
inline constexpr double kLandingUnit = 1.0 / 17592186044416.0;

struct LandingSettings {
  bool is_on = false;
  /// Horizontal speed in m/s at which snow leaves an edge.
  double throw_speed = 0.3;
  /// Slope by which falling snow spreads to all sides.
  double spread = 0.12;
  /// Edge in metres of the cubes whose snow falls together, and radius over which it lands.
  double heap_grain = 0.06;
  /// The most seconds that a fall takes, 0 to land at once.
  double longest_fall = std::numeric_limits<double>::infinity();
};

/// Snow that leaves a map over an outlet, off a wall or because it slides falls onto what lies
/// below: it is thrown off the edge, spreads on its way, and lands before a later step's deposit,
/// so that this step's repose shapes the heap. Volumes are whole units, so that nothing is lost.
class Landing {
 public:
  /// `rays` must know the objects. Snow in the air stays.
  void lay_out(const SceneRays& rays);

  /// Adds the snow that lands on these maps within the next `dt` seconds; sets their `landed` and
  /// `has_changed`. `repose_of`: by object; called from several threads.
  void arrive(double dt, const LandingSettings& settings, const std::vector<MovingMap*>& maps,
              const std::function<Repose&(size_t)>& repose_of);
  /// Whether any snow lands within the next `dt` seconds.
  bool has_arrivals(double dt) const {
    return !air_.empty() && std::get<0>(air_.begin()->first) <= clock_ + microseconds(dt);
  }
  /// Collects what left a map in this step: what repose has `released`, and what stability let
  /// slide.
  void release(const LandingSettings& settings, const std::vector<Release>& released,
               MovingMap& map, Repose& repose);
  /// Ends the step: throws down what was collected. `dt`: of the step, in seconds. `flying`: takes
  /// what is on its way; may be null.
  void fall(uint32_t step_number, double dt, const LandingSettings& settings,
            std::vector<FlyingSnow>* flying = nullptr);

  LandingState state() const;
  void set_state(const LandingState& state);

 private:
  /// A cube with edges of heap_grain.
  using Cube = std::array<int64_t, 3>;
  struct HashOfCube {
    size_t operator()(const Cube& cube) const {
      uint64_t h = 0;
      for (const int64_t i : cube) h = (h ^ static_cast<uint64_t>(i)) * 0x9E3779B97F4A7C15u;
      return static_cast<size_t>(h ^ (h >> 32));
    }
  };
  /// Snow that leaves a surface, or falls together.
  struct Exit {
    Cube key{};
    glm::dvec3 point{0.0};
    glm::dvec2 outwards{0.0};
    int64_t units = 0;
    /// A receiver that it leaves.
    int32_t object = 0;
  };
  struct Landed {
    /// Without an object: it leaves the scene.
    MapPoint point;
    /// The straight way through the air, in metres, and its height.
    glm::dvec2 aside{0.0};
    double drop = 0.0;
    int64_t units = 0;
  };
  std::vector<Exit> merged();
  void trace(const Exit& cell, uint32_t step_number, const LandingSettings& settings,
             std::vector<Landed>& landed) const;
  static int64_t microseconds(double seconds) {
    return static_cast<int64_t>(std::llround(1e6 * std::min(seconds, 1e9)));
  }

  /// Time of landing, object, place and side of snow in the air.
  using Place = std::tuple<int64_t, int32_t, int32_t, bool>;
  const SceneRays* rays_ = nullptr;
  std::vector<std::string> names_;
  /// By cube, what leaves it in this step; points and directions are sums, weighted by units.
  std::unordered_map<Cube, Exit, HashOfCube> exits_;
  /// See LandingState.
  int64_t clock_ = 0;
  std::map<Place, int64_t> air_;
  int64_t on_floors_ = 0;
  int64_t left_ = 0;
};

}  // namespace snowbough::snow
