#pragma once

#include <cstdint>
#include <vector>

#include "snow/seam_table.h"

namespace snowbough::snow {

/// Rounds for the points that the first round leaves too far apart.
inline constexpr int32_t kFineRounds = 30;
/// What part of the height at a seam the sides may differ by; heights under least_height count as
/// that.
inline constexpr float kLevelWithin = 0.006f;
/// By what part of its height (and of least_height) a fine round may move a texel at most from
/// where the first round left it: layouts with folds ask for what no height can do, and would get
/// spikes.
inline constexpr float kMostChange = 0.4f;

/// How far fine round `round` (from 0) goes on in the direction of the one before.
inline constexpr float fine_momentum(int32_t round) {
  return static_cast<float>(round) / static_cast<float>(round + 3);
}

/// Makes both sides of every seam show the same height, as a bilinear reader sees them. Only texels
/// within a texel of a seam change; the volume changes with them, by about a part in 10,000.
///
/// All seams get a round of averaging, which leaves a fifth of the difference or less where snow
/// lies evenly. Where it thins out over a few texels, as at a shadow's edge, some hundredths of the
/// little that lies there remain. Points with such a difference, and those that share a texel with
/// them, get kFineRounds more, which hurry on in the direction of the round before: Y. Nesterov, A
/// method for solving the convex programming problem with convergence rate O(1/k^2), 1983. How much
/// a point takes part grows from 0 at kLevelWithin to 1 at twice that, so that whoever rounds
/// otherwise comes to the same map.
class SeamLeveller {
 public:
  /// Keeps no reference to `levelling`.
  explicit SeamLeveller(const SeamLevelling& levelling);

  /// `map`: resolution^2 heights, continued beyond the charts; changed in place.
  void run(std::vector<float>& map);

 private:
  /// What a point looks at: kTerms texels (the rest filled up with weight 0), whose weighted sum is
  /// half of the difference there.
  static constexpr size_t kTerms = 8;
  struct Point {
    int32_t source[kTerms] = {};
    float weight[kTerms] = {};
  };

  void refresh_copies(std::vector<float>& heights) const;
  float mark_of(const Point& point) const;
  void mark();
  void take_marked();
  /// Spreads the point's difference, times `share`, over the texels it looks at, in changes_.
  void spread(const Point& point, float share, const std::vector<float>& heights);
  float changed(size_t texel, const std::vector<float>& heights);

  /// The texels that some point looks at, by linear index, ascending; then copies of some: a texel
  /// that a side looks at although it is another chart's must not change on that side's account.
  std::vector<int32_t> texel_;
  size_t first_copy_ = 0;
  std::vector<int32_t> copy_of_;
  /// What turns a texel's sum of changes into their mean; 0 for a copy.
  std::vector<float> scale_;
  float least_height_ = 0.0f;
  std::vector<Point> points_;

  std::vector<float> heights_;
  std::vector<float> ahead_;
  std::vector<float> start_;
  std::vector<float> changes_;
  std::vector<float> texel_marks_;
  /// What the fine rounds work on.
  std::vector<Point> fine_points_;
  std::vector<float> fine_shares_;
  std::vector<int32_t> fine_texels_;
};

}  // namespace snowbough::snow
