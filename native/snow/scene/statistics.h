#pragma once

#include <map>
#include <string>

#include "shaders/lib/snow_shared.h"

namespace snowbough::snow {

/// A balance of snow, of one object or of all: volumes in m3, areas in m2.
struct SnowBalance {
  /// Volume deposited on maps, and slid off them.
  double deposited_volume = 0.0;
  double slid_volume = 0.0;
  /// Volume that has fallen off a map and landed on this one.
  double landed_volume = 0.0;
  /// Volume that masks have refused, that objects have pressed or cleared away, that has melted,
  /// and that the wind has carried away less what it has brought; and, in totals only, each kind.
  double removed_volume = 0.0;
  double masked_volume = 0.0;
  double pressed_volume = 0.0;
  double cleared_volume = 0.0;
  double melted_volume = 0.0;
  double drifted_volume = 0.0;
  /// Volume on the maps now.
  double held_volume = 0.0;
  /// Change of volume because surfaces stretched or shrank under the snow.
  double stretched_volume = 0.0;
  /// Area seen from the sky, measured perpendicular to the fall: of faces that gather,
  /// and of back faces, which gather nothing.
  double visible_area = 0.0;
  double back_face_area = 0.0;

  /// Back faces as a fraction of the area that the sky sees: a high value suggests flipped normals.
  double back_face_share() const {
    const double seen = visible_area + back_face_area;
    return seen > 0.0 ? back_face_area / seen : 0.0;
  }
};

/// The last step, and all steps so far.
struct StatisticsPair {
  SnowBalance step;
  SnowBalance total;
};

struct SnowStatistics {
  StatisticsPair all;
  /// Receivers only, by name.
  std::map<std::string, StatisticsPair> objects;
  /// Of what has fallen off maps: volume in the air now, on objects without a map, and outside of
  /// the scene, in m3. Deposited snow is held, stretched, removed, or one of these.
  double air_volume = 0.0;
  double floor_volume = 0.0;
  double left_volume = 0.0;
  uint32_t step_number = 0;
};

/// Turns an engine's sums into a balance.
StatisticsPair balance_of(const shared::ObjectSums& sums);
/// Adds `other` to `sum`.
void add_balance(StatisticsPair& sum, const StatisticsPair& other);

}  // namespace snowbough::snow
