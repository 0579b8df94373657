#pragma once

#include <map>
#include <string>

#include "shaders/lib/snow_shared.h"

namespace snowbough::snow {

/// A balance of snow, of one object or of all: volumes in m3, areas in m2.
struct SnowBalance {
  /// Volume put on maps, and slid off them.
  double deposited_volume = 0.0;
  double slid_volume = 0.0;
  /// Volume that lies there now.
  double held_volume = 0.0;
  /// Change of volume because surfaces stretched or shrank under the snow.
  double stretched_volume = 0.0;
  /// Area seen from the sky, measured perpendicular to the fall: of front faces, and of back faces,
  /// which gather nothing.
  double visible_area = 0.0;
  double back_face_area = 0.0;

  /// Which share of what the sky sees is back faces: much of it hints at flipped normals.
  double back_face_share() const {
    const double seen = visible_area + back_face_area;
    return seen > 0.0 ? back_face_area / seen : 0.0;
  }
};

/// The last step, and all steps since the beginning.
struct StatisticsPair {
  SnowBalance step;
  SnowBalance total;
};

struct SnowStatistics {
  StatisticsPair all;
  /// Receivers only, by name.
  std::map<std::string, StatisticsPair> objects;
  uint32_t step_number = 0;
};

/// Turns an engine's sums into a balance.
StatisticsPair balance_of(const shared::ObjectSums& sums);
/// Adds `other` to `sum`.
void add_balance(StatisticsPair& sum, const StatisticsPair& other);

}  // namespace snowbough::snow
