#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <vector>

#include "snow/movement/rays/map_point.h"
#include "snow/movement/rays/scene_rays.h"
#include "snow/movement/repose/repose.h"

namespace snowbough::snow {

/// What lies beyond an outlet: an open edge of the surface, or its end above a wall.
struct OutletTarget {
  /// Height of the outlet in the world, in metres.
  float z = 0.0f;
  /// Whether a body continues there, so that nothing falls.
  bool is_closed = false;
  /// The first surface below; none if snow leaves the scene.
  MapPoint fall;
  /// Distance in metres within which no surface of about the same height lies across the air;
  /// infinite if none is to be searched.
  float searched = 0.0f;
  /// The distance of the nearest such surface; 0: not found yet.
  float width = 0.0f;
  /// The first top nearer than it that is a step lower, and its distance in metres; 0: none.
  MapPoint step;
  float step_width = 0.0f;
  /// Whether the far side belongs to a wall that ends far above.
  bool is_at_wall = false;
  /// The surfaces that wide a way beyond the outlet, twice as far, and the same way before it.
  MapPoint far, farther, before;
};

/// What lies beyond the outlets of a scene's receivers, found with rays when first needed in a pose
/// (gain: 16 % of a bake). Snow above an outlet is bounded by the top of the snow beyond, not by
/// the end of its own surface: it joins what lies a step lower, and closes narrow gaps.
class OutletTargets {
 public:
  /// `objects` must live until the next call.
  void lay_out(const std::vector<const SceneObject*>& objects);
  /// Call it when an object's positions have changed. Calls `forget(object)` for the objects near
  /// it, and for itself.
  template <typename Forget>
  void forget_pose(size_t object, const Forget& forget) {
    rays_.forget_pose(object);
    const Bounds before = bounds_[object];
    bounds_[object] = rays_.objects()[object]->bounds;
    const ObjectDescription& moved = rays_.objects()[object]->description;
    // No ray ends at others.
    if (!moved.receive && !moved.occlude) return;
    for (size_t i = 0; i < bounds_.size(); ++i) {
      if (i != object && !is_near(i, before) && !is_near(i, bounds_[object])) continue;
      targets_[i].clear();
      forget(i);
    }
  }

  /// Raises the chosen outlets of a receiver to the top of the snow beyond. `heights`: by object,
  /// before any map of the step changes; null: its snow does not count.
  void raise(size_t object, Repose& repose, const std::vector<const std::vector<float>*>& heights);

  const SceneRays& rays() const { return rays_; }

 private:
  bool is_near(size_t object, const Bounds& moved) const;
  MapPoint below(const glm::dvec3& from, double over, bool& is_closed) const;
  OutletTarget find(const Outlet& outlet) const;
  bool is_anything_across(const Outlet& outlet) const;
  static float rise_of(const OutletTarget& target, float widest, float near, float slope,
                       const std::vector<const std::vector<float>*>& heights);
  void find_gap(const Outlet& outlet, float widest, OutletTarget& target) const;

  SceneRays rays_;
  /// By object: its bounds when its targets were last forgotten.
  std::vector<Bounds> bounds_;
  /// By object, resolution of its map, and block, of outlets by OutletLink::number.
  std::vector<std::map<int32_t, std::vector<std::map<int32_t, OutletTarget>>>> targets_;
};

}  // namespace snowbough::snow
