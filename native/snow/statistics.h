#pragma once

#include <map>
#include <string>
#include <vector>

#include "gpu/program.h"
#include "snow/scene_buffers.h"
#include "snow/walkers.h"

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

/// Turns sums as they lie on the GPU into a balance.
StatisticsPair balance_of(const shared::ObjectSums& sums);
/// Adds `other` to `sum`.
void add_balance(StatisticsPair& sum, const StatisticsPair& other);

/// Keeps the books of every receiver on the GPU, so that no step has to wait for a read.
class StatisticsPass {
 public:
  /// `walkers`: the stability pass's. GPU thread.
  explicit StatisticsPass(int32_t walkers = snow::walkers())
      : sums_({"statistics.comp.glsl"}, {walkers_define(walkers)}) {}

  /// Sets the step's sums to zero; before the deposit. GPU thread.
  void open(SceneBuffers& scene);
  /// Adds up the stability pass's work groups and brings the totals up to date. `pixel_area` in m2.
  /// GPU thread.
  void close(SceneBuffers& scene, float pixel_area);

 private:
  gpu::Program sums_;
  gpu::Program open_{{"statistics_step.comp.glsl"}, {"OPENING"}};
  gpu::Program close_{{"statistics_step.comp.glsl"}};
};

}  // namespace snowbough::snow
