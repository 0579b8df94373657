#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "snow/seams/least_squares.h"
#include "snow/seams/seam_layout.h"
#include "snow/seams/seam_marks.h"
#include "snow/seams/seam_refinement.h"
#include "snow/seams/seam_samples.h"

namespace snowbough::snow {

/// Makes both sides of every seam show the same height under bilinear interpolation. Changes only
/// texels with snow within a texel of a seam, and the volume by about 1/10,000 where snow covers
/// both sides. Where it ends at many seams, as on twigs, it removes up to 1/50. Simpler methods
/// that were measured: docs/dev/tried.md.
///
/// Solves two least-squares problems that minimise the differences between the sides and, with a
/// much smaller weight, the changes. The first covers all texels and points and leaves differences
/// of some thousandths of the height, more where snow thins out beside deep snow. It depends on the
/// layout alone (SeamLayout), so its matrix is factorised once. The second (SeamRefinement) covers
/// the points whose remaining difference is too large relative to their height (SeamMarks); points
/// that still differ too much are solved again, a few times, while that helps.
///
/// No texel falls below 0 or rises above the highest height that its points read. Where snow ends
/// on a seam, the points just beyond its end count too, since raising a texel for the last points
/// with snow must not show on one side alone.
///
/// Where charts are so small and numerous that factorising would take too long, some rounds of
/// conjugate gradients replace it. Keeping the factor from map to map takes no code and saves up to
/// 7 % of a bake's processor time (12 maps of a ball at 1024 texels; nothing on the tree AL06a).
class SeamLeveller {
 public:
  /// Keeps no reference to `levelling`.
  explicit SeamLeveller(const SeamLevelling& levelling);

  /// `map`: resolution^2 heights, extended beyond the charts; changed in place.
  void run(std::vector<float>& map);

  /// Memory kept between maps, in bytes.
  int64_t bytes() const;

 private:
  void collect_points();
  void add_bare_neighbours();
  void level_all();

  std::shared_ptr<const SeamLayout> layout_;
  SeamHeights heights_;
  SeamMarks marks_;
  SeamRefinement refinement_;
  bool factorised_ = false;
  /// Of the first problem, and per texel its right-hand side, then solution.
  SeamFactor factor_;
  std::vector<float> values_;
  /// The bare unknowns beside snow, and per texel whether it is one of them.
  std::vector<int32_t> bare_;
  std::vector<uint8_t> is_bare_;
};

}  // namespace snowbough::snow
