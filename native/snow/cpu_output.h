#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "snow/level_seams.h"
#include "snow/map_output.h"
#include "snow/seam_table.h"
#include "snow/smoothing.h"
#include "snow/surface_metric.h"
#include "snow/texel_table.h"

namespace snowbough::snow {

/// Smooths, continues and levels one receiver's map on the processor: what MapOutputPass does in
/// shaders. For software renderers, where it is many times faster than shaders are, and for maps
/// whose buffers the driver has no room for.
///
/// Texels whose neighbours lie beside them in the map are filtered row by row, many at a time; the
/// others take their neighbours from a list made once. Rows are shared among `threads` threads; the
/// result does not depend on their number.
class CpuOutput {
 public:
  /// `table` and `seams` must outlive it.
  CpuOutput(const TexelTable& table, const SeamTable& seams, const SmoothingPlan& plan,
            int32_t threads = 2);

  /// `stored`: the map's resolution^2 heights in metres, row 0 = v 0, 0 where nobody owns the
  /// texel. `metrics`: surface_metrics of the current positions, or empty where no normals are
  /// wanted.
  MapOutput run(const std::vector<float>& stored, const std::vector<SurfaceMetric>& metrics = {});

 private:
  /// Consecutive texels of a row, all with their neighbours beside them.
  struct Segment {
    int32_t first_texel;
    int32_t count;
  };
  /// One axis of the filter.
  struct Axis {
    const TexelLines* lines = nullptr;
    /// How far apart neighbours are in the map: 1 or resolution.
    int32_t stride = 1;
    /// Per texel of the map: scale of the taps, 0 to 1.
    std::vector<float> scale;
    std::vector<Segment> segments;
    /// Per other texel: its linear index and where its neighbours' values are, at distances -4 ..
    /// -1, 1 .. 4 (index into the heights followed by the ghosts).
    std::vector<int32_t> odd_texel;
    std::vector<uint8_t> odd_level;
    std::vector<std::array<int32_t, 2 * kFilterReach>> odd_taps;
  };

  void prepare(Axis& axis, const TexelLines& lines, int32_t stride,
               const std::vector<uint8_t>& level);
  void fill_ghosts(const Axis& axis, std::vector<float>& heights) const;
  /// Filters `from` along an axis into `to`; `add` halves and adds to what is there.
  void filter(const Axis& axis, std::vector<float>& from, std::vector<float>& to, bool add) const;

  const TexelTable& table_;
  const SeamTable& seams_;
  int32_t passes_ = 0;
  int32_t closing_passes_ = 0;
  int32_t threads_ = 1;
  SeamLeveller leveller_;
  Axis u_;
  Axis v_;
  /// resolution^2 heights, then the ghosts of one axis.
  std::vector<float> heights_;
  std::vector<float> next_;
};

}  // namespace snowbough::snow
