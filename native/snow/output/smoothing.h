#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/zeroed_array.h"
#include "snow/output/smoothing_grid.h"

namespace snowbough::snow {

struct ConductanceTerms;

/// Amount of smoothing: the standard deviation is the larger of `blur_radius` and a third of the
/// local depth, in metres. 0: no smoothing.
struct SmoothingSettings {
  float blur_radius = 0.0f;
};

/// @throws std::invalid_argument for a negative or not finite radius.
void check_smoothing(const SmoothingSettings& settings);

/// Smooths a map's snow by diffusion in flux form: each texel loses exactly the volume that its
/// neighbour gains, so the volume is kept up to rounding.
///
/// - A link's conductivity follows from the snow at its thinner end, so that little snow flows to
///   where it tapers off: sigma = blur_radius or a third of the depth, whichever is larger.
/// - Nothing flows onto bare texels, onto texels that hold less than a fiftieth of their neighbour,
///   or between the positive side and the back, whose heights are negative.
///
/// A map says how much snow lies where; how its edges look is up to the snow's surface.
///
/// Every stage is explicit and moves at most a fifth of a difference, which keeps all heights
/// within their previous range. Over long distances snow moves between blocks of 2 x 2, 4 x 4, ..
/// texels: one stage per level on the way up and three on the way down (a V cycle), at the cost of
/// about five passes over the map for any sigma up to a hundred texels.
///
/// P. Perona, J. Malik, Scale-Space and Edge Detection Using Anisotropic Diffusion, 1990 (fluxes
/// between texels); W. Briggs, V. Henson, S. McCormick, A Multigrid Tutorial, 2000 (V cycle).
class Smoother {
 public:
  /// `grid` must outlive it. The result does not depend on `threads`.
  Smoother(const SmoothingGrid& grid, const SmoothingSettings& settings, int32_t threads);

  /// `map`: a grid's heights in metres; changed in place. One call at a time.
  void run(std::vector<float>& map);

 private:
  /// Half-open range of cells of one row that may hold snow.
  struct Run {
    int32_t begin;
    int32_t end;
  };
  /// A link of SmoothingLevel::link_other that snow may cross, seen from a cell with snow.
  struct OpenLink {
    int32_t other;
    float weight;
    float closeness;
    /// m2 per stage.
    float conductance;
  };
  /// The cells of some rows with such links; the links of cells[c] end at links[cells[c].end].
  struct OpenLinks {
    struct Cell {
      int32_t cell;
      int32_t end;
    };
    std::vector<Cell> cells;
    std::vector<OpenLink> links;
  };
  /// Working data of a level. Arrays have a margin of kMargin cells and a row before the first
  /// cell.
  struct Level {
    ptrdiff_t margin = 0;
    /// Height in metres, before and after a stage.
    base::ZeroedArray<float> height;
    base::ZeroedArray<float> next;
    /// Conductance of the links to the right and above, m2 per stage. 0 beyond the runs.
    base::ZeroedArray<float> right;
    base::ZeroedArray<float> above;
    /// 1 / area.
    base::ZeroedArray<float> inverse_weight;
    /// The height before the level's stages.
    base::ZeroedArray<float> before;
    /// Per band of rows.
    std::vector<OpenLinks> loose;
    std::vector<Run> runs;
    /// Per row, where its runs begin.
    std::vector<int32_t> run_row;
    std::vector<uint8_t> reassigned_joins;

    float* at(const base::ZeroedArray<float>& values) const { return values.data() + margin; }
  };

  /// Pool of working arrays, in use only during a run: there are many receivers, but few maps at a
  /// time.
  class Workspace;

  void make_level(size_t number);
  int32_t band_count(const SmoothingLevel& grid) const;
  void for_each_row_band(
      const SmoothingLevel& grid,
      const std::function<void(size_t band, int32_t first, int32_t last)>& work) const;
  void for_each_run(size_t number, const std::function<void(Run run)>& work) const;
  void find_runs(const std::vector<float>& map);
  void clear_beyond_runs(size_t number, const std::vector<Run>& before);
  void load(const std::vector<float>& map);
  /// Lists the open links across seams.
  void open_loose_links(size_t number);
  float damping_of_block(size_t number, int32_t block) const;
  /// Returns the largest variance over distance^2 of a link.
  float conduct(size_t number);
  void stages(size_t number, int32_t count);
  void restrict_to(size_t number);
  void prolong_from(size_t number);
  void cycle(size_t number, float variance);
  void store(std::vector<float>& map);

  const SmoothingGrid& grid_;
  float least_variance_;
  int32_t threads_;
  /// Per level: half the variance over distance^2 that finer levels provide.
  std::vector<float> done_below_;
  /// Only during a run.
  std::vector<Level> levels_;
};

}  // namespace snowbough::snow
