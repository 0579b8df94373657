#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "snow/movement/coarse_map.h"
#include "snow/movement/drift/drift.h"
#include "snow/movement/landing.h"
#include "snow/movement/masks.h"
#include "snow/movement/melt/thaw.h"
#include "snow/movement/melt/water.h"
#include "snow/movement/moving_map.h"
#include "snow/movement/outlet_targets.h"
#include "snow/movement/pressing.h"
#include "snow/movement/repose/repose.h"
#include "snow/movement/shedding.h"

namespace snowbough::snow {

/// Name of the plane of water in checkpoints.
inline constexpr const char* kWaterPlane = "water";

struct MovementSettings {
  ReposeSettings repose;
  LandingSettings landing;
  /// Depth in metres that level ground holds; masks scale it.
  float max_depth = 1.0f;
  MeltSettings melt;
  DriftSettings drift;
  /// Whether to record what flies.
  bool records_flying = false;
};

/// What a step's sun, or rain, brings to each receiver's surface, relative to open level ground.
struct LightMap {
  /// The direction in which it was computed; 0: not yet, or for another pose.
  glm::dvec3 direction{0.0};
  /// By object and place on its map.
  std::vector<std::vector<float>> light;

  const std::vector<float>* of(size_t object) const {
    return light.empty() || light[object].empty() ? nullptr : &light[object];
  }
};

/// The passes that move lying snow, on the CPU's cores, for either engine: `before` a step's
/// deposit adds what lands; `after` stability lets what is too steep move, and what leaves a map
/// fall.
class Movement {
 public:
  /// Maximum memory in bytes, if snow covers these objects.
  static int64_t memory(const std::vector<const SceneObject*>& objects);

  /// `objects` must live until the next call.
  void lay_out(const std::vector<const SceneObject*>& objects);
  void forget_pose(size_t object);

  /// Whether any snow lands in the next step. `dt`: its duration in seconds.
  bool has_arrivals(double dt) const { return landing_.has_arrivals(dt); }
  /// Whether the next step needs `before` and `after` even if no snow lands or moves by itself.
  bool acts_always() const { return masks_.is_on() || pressing_.is_on() || shedding_.is_on(); }
  void before(const MovementSettings& settings, double dt, std::vector<MovingMap>& maps);
  /// A longer step may run more rounds until all snow rests; without duration only what stability
  /// has released moves.
  void after(const MovementSettings& settings, uint32_t step_number, double dt,
             std::vector<MovingMap>& maps);

  /// Number of rounds of repose in the last step, of blocks of kReposeBlock texels a side.
  double rounds() const { return rounds_; }
  /// What has begun to fly since the last call, if the settings record it.
  std::vector<FlyingSnow> take_flying() { return std::exchange(flying_, {}); }
  /// Maps of the sun's light and of the rain, which the engine computes before `before`.
  LightMap sun, rain;
  /// A receiver's water in metres (see Water), resolution x resolution; empty: none.
  std::vector<float> water(size_t object) const { return water_.state(object); }

  LandingState landing() const { return landing_.state(); }
  /// What the passes keep between steps: of the scene, and of a receiver.
  void save(SimulationState& state) const;
  void save(size_t object, ObjectState& state) const;
  void load(const SimulationState& state);
  void load(size_t object, const ObjectState& state);

 private:
  std::vector<MovingMap*> shown(std::vector<MovingMap>& maps) const;
  /// A map on which snow comes to rest: the receiver's own or a coarser one.
  struct Resting {
    /// The receiver's.
    MovingMap* own = nullptr;
    Repose* repose = nullptr;
    /// Null: the map is the receiver's own.
    CoarseMap* coarse = nullptr;
    /// As for Repose::choose_blocks.
    std::vector<int32_t> blades = {};
    std::vector<uint8_t> within = {};
    /// What CoarseMap::begin has made.
    MovingMap coarser = {};
    ReposeResult moved = {};

    MovingMap& map() { return coarse == nullptr ? *own : coarser; }
  };
  void rest(const MovementSettings& settings, double dt, bool of_blades,
            const std::vector<MovingMap*>& maps);
  void choose_maps(const MovementSettings& settings, double dt, MovingMap& map, bool of_blades,
                   std::vector<Resting>& first, std::vector<Resting>& then);
  void rest_on(const MovementSettings& settings, double dt, bool of_blades,
               const std::vector<MovingMap*>& all, std::vector<Resting>& maps);
  void run_repose(const MovementSettings& settings, float dt, bool of_blades,
                  const std::vector<MovingMap*>& all, std::vector<Resting>& maps);

  std::unique_ptr<ReposeLinkTables> link_tables_;
  OutletTargets targets_;
  CoarseMaps coarse_;
  double rounds_ = 0.0;
  std::vector<FlyingSnow> flying_;
  Masks masks_;
  Shedding shedding_;
  Pressing pressing_;
  Thaw thaw_;
  Water water_;
  Landing landing_;
  Drift drift_;
  /// By object; null for objects that do not receive.
  std::vector<std::unique_ptr<Repose>> receivers_;
};

}  // namespace snowbough::snow
