#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "snow/movement/melt/thaw.h"
#include "snow/movement/moving_map.h"
#include "snow/movement/rays/map_point.h"
#include "snow/movement/repose/repose.h"

namespace snowbough::snow {

/// Water on receivers, in metres of thickness per texel: melted snow and rain. A surface soaks it
/// up and spreads it; what is more runs down the surface, on walls too, wets its whole way, and
/// drips from edges onto what lies below. It dries, faster in the sun and slower under snow.
class Water {
 public:
  /// `rays` must know the objects. Forgets the water.
  void lay_out(const SceneRays& rays);
  void forget_pose(size_t object);

  /// A step of `dt` seconds on a map. `melted`: as from Thaw::melt. `sun`, `rain`: by place, light
  /// and rain relative to open level ground; null: none.
  void flow(const MeltSettings& settings, double dt, const std::vector<float>& melted,
            const std::vector<float>* sun, const std::vector<float>* rain, const MovingMap& map,
            Repose& repose, const LinkedRuns& runs);
  /// Ends the step: lets drip what has left edges; if not `lands`, it is gone.
  void drip(bool lands);

  /// A receiver's water as a plane, resolution x resolution; empty: none.
  std::vector<float> state(size_t object) const;
  /// Null: none.
  void set_state(size_t object, const std::vector<float>* plane);

 private:
  /// Ends of ways: a texel, from whose lower side water drips.
  static constexpr int32_t kStays = -1;
  struct Film {
    /// By texel, empty before there is any.
    std::vector<float> depth;
    /// Of the current pose; empty: not known. By texel: the next one down, kStays, or -2 - outlet;
    /// and the texels from which water runs, so that each comes before the next.
    std::vector<int32_t> next, order;
    /// By outlet, or -1 - texel of a wall's or an underside's lower edge, in this pose: where water
    /// lands. Only looked up.
    std::unordered_map<int32_t, MapPoint> targets;
    /// By texel in m2, of the current pose; empty: not known.
    std::vector<float> area;
  };
  struct Drip {
    int32_t object = -1, place = -1;
    double volume = 0.0;
  };
  void find_ways(size_t object, Repose& repose);
  float soak_sideways(const MeltSettings& settings, double dt, const LinkedRuns& runs,
                      const std::vector<int32_t>& places, const ReposeLinks& links, double area,
                      Film& own);
  void run_down(const MeltSettings& settings, size_t object, Repose& repose);
  MapPoint below(size_t object, int32_t from, int32_t texel, Repose& repose) const;

  const SceneRays* rays_ = nullptr;
  std::vector<Film> films_;
  std::vector<Drip> drips_;
  /// By texel; a member to keep its memory.
  std::vector<float> spread_;
};

}  // namespace snowbough::snow
