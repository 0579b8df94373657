#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <mutex>
#include <vector>

#include "snow/output/dilate.h"
#include "snow/output/map_output.h"
#include "snow/output/map_tiles.h"
#include "snow/output/smoothing.h"
#include "snow/seams/seam_leveller.h"
#include "snow/seams/seam_table.h"
#include "snow/seams/surface_metric.h"
#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// Smooths, continues and levels one receiver's map on the processor: what SmoothingPass and
/// NormalsPass do in shaders, and the levelling. For the engine without OpenGL, and for maps whose
/// buffers the driver has no room for.
///
/// Texels whose neighbours lie beside them in the map are filtered row by row, many at a time; the
/// others take their neighbours from a list made once. Tiles that no snow comes near are passed
/// over: they stay at 0. The others are shared among `threads` threads; the result does not depend
/// on their number. Several threads may call run() at once: one filters a map while another levels
/// the one before.
class CpuFilter {
 public:
  /// `table` and `seams` must outlive it.
  CpuFilter(const TexelTable& table, const SeamTable& seams, const SmoothingPlan& plan,
            int32_t threads = 2);

  /// `map`: its resolution^2 heights as stored, in metres, row 0 = v 0, 0 where no chart owns the
  /// texel; handed back as the output's. `metrics`: surface_metrics of the current positions, or
  /// empty where no normals are wanted.
  MapOutput run(std::vector<float> map, const std::vector<SurfaceMetric>& metrics = {});

 private:
  /// A texel whose neighbours do not all lie beside it on the map. Places are those of Heights.
  struct IrregularTexel {
    int32_t texel;
    int32_t level;
    /// Sum of the weights of the neighbours that are there.
    float present;
    /// Neighbours' values at distances -1, 1, -2, 2, ..
    std::array<int32_t, size_t{2} * kFilterReach> taps;
  };
  /// One axis of the filter.
  struct Axis {
    /// How far apart neighbours are in the map: 1 or resolution.
    int32_t stride = 1;
    /// Per texel of the map: scale of the taps in steps of kFilterScaleStep; kIrregular where it is
    /// irregular or no chart's.
    std::vector<uint16_t> scale;
    /// Per tile: whether it has regular texels.
    std::vector<uint8_t> has_regular;
    /// In the order of tiles, and where each tile begins.
    std::vector<int32_t> irregular_begin;
    std::vector<IrregularTexel> irregular;
    /// The tiles that a tile's texels look at, its own included.
    TileReads reads;
    /// The ghosts, as sums over texels (linear index), in the order of the tiles that these lie in:
    /// Irregular texels look all over the map, so what they look at is put beside each other first.
    std::vector<int32_t> ghost_begin;
    WeightedRows ghosts;
    /// Where each of them goes.
    std::vector<int32_t> ghost_place;
    TileReads ghost_reads;
  };
  /// A map's heights with a margin of zeros before and behind, as wide as a filter reaches along v;
  /// then a zero and the ghosts of one axis. Places count from the first height.
  struct Heights {
    std::vector<float> values;
    ptrdiff_t margin = 0;
    /// Per tile: whether it may hold anything but 0.
    std::vector<uint8_t> filled;

    float* map() { return values.data() + margin; }
    const float* map() const { return values.data() + margin; }
  };
  static constexpr uint16_t kIrregular = 0xFFFF;

  void prepare(Axis& axis, const TexelLines& lines, int32_t stride,
               const std::vector<uint8_t>& level);
  void add_ghosts(Axis& axis, const TexelLines& lines);
  /// The place of a value that is always 0; ghosts follow.
  int32_t zero_place() const { return (table_.resolution + kFilterReach) * table_.resolution; }
  /// Smooths a map in place and continues it beyond the charts.
  void smooth(std::vector<float>& map);
  void load(const std::vector<float>& stored);
  /// Puts the heights into the map that was loaded.
  void store(std::vector<float>& map);
  void clear_tile(Heights& heights, int32_t tile) const;
  /// Filters `from` along an axis into `to`; `add` halves and adds to what is there.
  void filter(const Axis& axis, Heights& from, Heights& to, bool add) const;
  /// Calls `work` for all rows of tiles.
  void for_each_tile_row(const std::function<void(int32_t row)>& work) const;
  /// Fills in the ghosts that the texels of a row of tiles give.
  void fill_ghosts(const Axis& axis, Heights& from, int32_t row) const;
  /// The same for the tiles of a row of tiles that `to.filled` names; sets that to what they hold.
  void filter_tile_row(const Axis& axis, const Heights& from, Heights& to, bool add,
                       int32_t row) const;
  uint32_t filter_irregular(const Axis& axis, const Heights& from, Heights& to, bool add,
                            int32_t tile) const;

  const TexelTable& table_;
  const SeamTable& seams_;
  int32_t passes_ = 0;
  int32_t closing_passes_ = 0;
  int32_t threads_ = 1;
  std::mutex levelling_;
  SeamLeveller leveller_;
  MapContinuation continuation_;
  MapTiles tiles_;
  Axis u_;
  Axis v_;
  std::mutex filtering_;
  Heights heights_;
  Heights next_;
};

}  // namespace snowbough::snow
