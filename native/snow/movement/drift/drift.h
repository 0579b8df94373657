#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "snow/movement/drift/transport.h"
#include "snow/movement/moving_map.h"
#include "snow/movement/repose/repose.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

struct DriftSettings {
  /// Horizontal unit vector in which the wind blows.
  glm::dvec2 wind{0.0};
  /// See transport; 0: no drifts.
  double flux = 0.0;

  bool is_on() const { return flux > 0.0 && wind != glm::dvec2(0.0); }
};

/// Lets the wind carry lying snow: away before obstacles, into their shelter, and onto other
/// receivers. It works on a grid of cells in the wind's axes; each texel that the wind reaches
/// belongs to the four cells around it by distance, so that cells do not show. It reaches ground
/// and roofs under the open sky, and no walls. What leaves a map counts as MovingMap::drifted. All
/// depends on the heights and the current pose alone.
class Drift {
 public:
  /// `objects` must live until the next call.
  void lay_out(const std::vector<const SceneObject*>& objects);
  /// Call it when any object's positions, or whether it is hidden, have changed.
  void forget_pose() { is_known_ = false; }

  struct Receiver {
    MovingMap* map = nullptr;
    Repose* repose = nullptr;
    /// By texel: thickness in metres of packed snow, which stays; empty: none.
    const std::vector<float>* packed = nullptr;
  };
  void blow(const DriftSettings& settings, const std::vector<Receiver>& receivers);

 private:
  /// The texels of a receiver that the wind reaches, by the first of their four cells.
  struct Reached {
    size_t object = 0;
    /// By cell, with the end: into the rest.
    std::vector<int32_t> begin;
    /// In the table, and on the map.
    std::vector<int32_t> texel, place;
    /// Area in m2, upward part of the normal, and part of the way to the next column and row.
    std::vector<float> area, up, x, y;
  };
  void find_ground(const DriftSettings& settings, const std::vector<Receiver>& receivers);
  std::vector<float> tops_of_objects(glm::ivec2 low) const;
  void reach(const Receiver& receiver, glm::ivec2 low, const std::vector<float>& tops);
  template <typename Visit>
  void for_columns(const Visit& visit) const;
  void find_snow(const Receiver& receiver, const Reached& reached);
  void move_snow(const Receiver& receiver, const Reached& reached) const;
  glm::dvec2 in_wind(const glm::vec3& point) const;

  std::vector<const SceneObject*> objects_;
  bool is_known_ = false;
  glm::dvec2 wind_{0.0};
  /// The ground without snow.
  DriftGrid grid_;
  std::vector<Reached> reached_;
  /// By cell: this step's depth that comes, and share of the loose snow that leaves.
  std::vector<glm::vec2> moves_;
};

}  // namespace snowbough::snow
