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

/// Makes both sides of every seam show the same height under bilinear interpolation. Changes only
/// texels with snow within a texel of a seam, and the volume by about 1/10,000.
///
/// Solves two least-squares problems that minimise the differences between the sides and, with a
/// much smaller weight, the changes. The first covers all texels and points and leaves differences
/// of some thousandths of the height, more where snow thins out beside deep snow. It depends on the
/// layout alone, so its matrix is factorised once. The second covers the points whose remaining
/// difference is too large relative to their height, and is factorised for each map; points that
/// still differ too much are solved again, a few times, while that helps. No texel falls below 0 or
/// rises above the highest height that its points read: it stays at its limit, and the texels
/// connected to it are solved once more. Where snow ends on a seam, the points just beyond its end
/// count too, since raising a texel for the last points with snow must not show on one side alone.
///
/// A texel's participation in the second problem grows continuously from 0 at kLevelWithin, so that
/// rounding differences do not change the map.
///
/// Where charts are so small and numerous that factorising would take too long, some rounds of
/// conjugate gradients replace it.
class SeamLeveller {
 public:
  /// Keeps no reference to `levelling`.
  explicit SeamLeveller(const SeamLevelling& levelling);

  /// `map`: resolution^2 heights, extended beyond the charts; changed in place.
  void run(std::vector<float>& map);

  /// Memory kept between maps, in bytes.
  int64_t bytes() const;

 private:
  /// A point with snow beside it: difference and sum of its sides' heights, in metres.
  struct SeamResidual {
    int32_t point;
    /// Whether it may have changed since its evaluation.
    bool may_differ;
    float gap;
    float height;
  };
  /// A point of the second problem, and the weight of its difference, per metre.
  struct FinePoint {
    int32_t point;
    float share;
  };

  SeamResidual residual_at(int32_t point) const;
  void level_all();
  void note(int32_t point, const SeamResidual& residual);
  void note_bare_neighbours();
  void refresh_foreign();
  /// Returns the number of texels whose points differed too much.
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

  /// The map's texels in elimination order; those from unknowns_ on are only read. Arrays with one
  /// value per texel have one more element at the end, 0, for points with fewer than kSeamTerms
  /// terms.
  std::vector<int32_t> texel_;
  int32_t unknowns_ = 0;
  float least_height_ = 0.0f;
  std::vector<SeamRow> points_;
  /// The points that read unknown i: [sample_begin_[i], sample_begin_[i + 1]) of samples_.
  std::vector<int32_t> sample_begin_;
  std::vector<int32_t> samples_;
  /// Texels that are only read because another chart owns them, and their index as that chart's.
  std::vector<std::pair<int32_t, int32_t>> foreign_;
  std::shared_ptr<const SeamPattern> pattern_;
  bool factorised_ = false;
  std::optional<SeamFactor> factor_;

  std::vector<float> heights_;
  /// Range of a texel's height: the highest and lowest heights read by the points that read it, or
  /// bare ground.
  std::vector<float> limits_;
  std::vector<float> lower_limits_;
  /// Right-hand side, then solution; 0 for texels outside the problem.
  std::vector<float> values_;
  std::vector<SeamResidual> residuals_;
  /// Per point: its index in residuals_; -1: no snow beside it.
  std::vector<int32_t> residual_of_;
  /// Indices into residuals_: of points that read other charts' texels; of points that may have
  /// changed, those of the second problem first.
  std::vector<int32_t> foreign_residuals_;
  std::vector<int32_t> changed_;
  /// Set of indices into residuals_.
  NumberSet active_bits_;
  /// The bare unknowns beside snow.
  std::vector<int32_t> bare_;
  /// Whether this map has marks.
  bool has_marks_ = false;
  /// The second problem. Per texel: its participation, 0 to 1, and the change of its height per
  /// unit of the solution.
  std::vector<float> marks_;
  std::vector<float> reach_;
  /// The unknowns with a mark, possibly some that have lost it, ascending.
  std::vector<int32_t> marked_;
  NumberSet marked_bits_;
  /// Per unknown: scratch flags, all 0 between uses.
  std::vector<uint8_t> is_seen_;
  std::vector<int32_t> fine_texels_;
  std::vector<FinePoint> fine_points_;
  std::optional<SeamFactor> fine_factor_;
};

}  // namespace snowbough::snow
