#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "snow/seams/least_squares.h"
#include "snow/seams/number_set.h"
#include "snow/seams/seam_samples.h"

namespace snowbough::snow {

/// Makes both sides of every seam show the same height, as a bilinear reader sees them. Only texels
/// within a texel of a seam change, and only where there is snow; the volume changes with them, by
/// about a part in 10,000.
///
/// Two least-squares problems, each solved exactly: what is left between the sides counts, and so,
/// much less, does every change. The first is over all texels and points and leaves differences of
/// some thousandths of the height, but more where snow thins out beside deep snow. It depends on
/// the layout alone, so that its matrix is factorised once. The second is over what the first left
/// too far apart, measured by the height there, and is factorised anew for each map; what it leaves
/// too far apart is solved again, a few times, while that helps. No texel falls below 0 or rises
/// above the highest that its points look at: where the second problem wants that, the texel stays
/// at its limit and what hangs together with it is solved once more. Where snow ends on a seam, the
/// points just beyond its end count too: their texels must not show on one side alone what they are
/// raised to for the last points with snow.
///
/// How much a texel takes part in the second problem grows slowly from 0 at kLevelWithin on, so
/// that whoever rounds otherwise comes to the same map.
///
/// Where charts are so small and so many that a factor would take too long, some rounds of
/// conjugate gradients take its place.
class SeamLeveller {
 public:
  /// Keeps no reference to `levelling`.
  explicit SeamLeveller(const SeamLevelling& levelling);

  /// `map`: resolution^2 heights, continued beyond the charts; changed in place.
  void run(std::vector<float>& map);

  /// What it keeps in memory from map to map.
  int64_t bytes() const;

 private:
  /// A point beside which snow lies, and what the sides show there: their difference and their sum,
  /// in metres.
  struct SeamResidual {
    int32_t point;
    /// Whether it may have changed since it was evaluated.
    bool may_differ;
    float gap;
    float height;
  };
  /// A point of the second problem, and what its difference counts there, per metre.
  struct FinePoint {
    int32_t point;
    float share;
  };

  SeamResidual residual_at(int32_t point) const;
  void level_all();
  void note(int32_t point, const SeamResidual& residual);
  void note_bare_neighbours();
  void refresh_foreign();
  /// Returns how many texels had points further apart than they may be.
  size_t refine();
  void mark();
  void mark_for(SeamResidual& residual);
  void activate_points();
  bool reads_foreign(const SeamRow& point) const;
  void begin_refinement();
  template <typename Visit>
  void for_each_fine_row(const Visit& visit);
  bool solve_fine();
  void solve_by_rounds(const std::vector<SeamRow>& rows, float damping, int32_t rounds);
  bool accept_within_limits();
  void solve_remaining();
  float fine_reach(int32_t texel) const;
  std::pair<float, float> fine_height(int32_t texel) const;

  /// The map's texels in the order of elimination; those from unknowns_ on are only read. Arrays of
  /// a value a texel have one more at the end, 0, for points that look at fewer than kSeamTerms.
  std::vector<int32_t> texel_;
  int32_t unknowns_ = 0;
  float least_height_ = 0.0f;
  std::vector<SeamRow> points_;
  /// The points that read unknown i: [sample_begin_[i], sample_begin_[i + 1]) of samples_.
  std::vector<int32_t> sample_begin_;
  std::vector<int32_t> samples_;
  /// Texels that are only read because they are another chart's, and what they are there.
  std::vector<std::pair<int32_t, int32_t>> foreign_;
  std::shared_ptr<const SeamPattern> pattern_;
  bool factorised_ = false;
  std::optional<SeamFactor> factor_;

  std::vector<float> heights_;
  /// What a texel may rise and fall to: the highest and the lowest that the points that look at it
  /// see, or bare ground.
  std::vector<float> limits_;
  std::vector<float> lower_limits_;
  /// What a solution is asked for, then what it is; 0 for texels that are not in the problem.
  std::vector<float> values_;
  std::vector<SeamResidual> residuals_;
  /// Per point: its index in residuals_; -1 = no snow lies beside it.
  std::vector<int32_t> residual_of_;
  /// Indices into residuals_: of points that read other charts' texels; that may have changed, of
  /// which those of the second problem come first.
  std::vector<int32_t> foreign_residuals_;
  std::vector<int32_t> changed_;
  /// Of indices into residuals_.
  NumberSet active_bits_;
  /// The bare unknowns beside snow.
  std::vector<int32_t> bare_;
  /// Whether marks have been made in this map.
  bool has_marks_ = false;
  /// The second problem. Per texel: how much it takes part, 0 to 1, and by how much one unit of the
  /// problem changes its height.
  std::vector<float> marks_;
  std::vector<float> reach_;
  /// The unknowns that have a mark, and maybe some that have lost it, ascending.
  std::vector<int32_t> marked_;
  NumberSet marked_bits_;
  /// Per unknown: used for a while, all 0 then.
  std::vector<uint8_t> is_seen_;
  std::vector<int32_t> fine_texels_;
  std::vector<FinePoint> fine_points_;
  std::optional<SeamFactor> fine_factor_;
};

}  // namespace snowbough::snow
